'use strict';
// One scene of the page in its part of the stage: what is carved and drawn of it.

const byId = id => document.getElementById(id);
const channels = colour => [1, 3, 5].map(n => parseInt(colour.slice(n, n + 2), 16) / 255);
const shellWord = text => /^[\w.,:=+%\/-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

/** Content that lies outside the lattice: what share of all, and the voxel where there is most; null if less than a thousandth.
 * @param places  Lattice.locate() */
function contentOutside({volume, places}, background) {
    let all = 0, outside = 0, most = 0, at = 0;
    for (let n = 0; places && n < volume.length; ++n) {
        const here = Math.abs(volume[n] - background);
        all += here;
        if (places[3 * n] === places[3 * n]) continue;
        outside += here;
        if (here > most) most = here, at = n;
    }
    return outside > 0.001 * all ? {share: outside / all, at} : null;
}

/** How many of the first `count` seams lie side by side at an edge of the window, in most columns of a frame.
 * @param order  seamOrder() */
function seamsAtEdge(set, order, count) {
    const before = set.shape[set.axis], columns = order.length / before, seen = new Int32Array(count + 1);
    for (let column = 0; column < columns; ++column)
        for (const [from, by] of [[set.window[0], 1], [set.window[1], -1]])
            for (let entry = from; entry >= set.window[0] && entry <= set.window[1]; entry += by) {
                const seam = order[column * before + entry];
                if (seam <= 0 || seam > count) break;
                ++seen[seam];
            }
    return seen.filter(each => each > columns / 2).length;
}

/** Counts whose steps a view keeps: at 96 voxels an axis, 4 MB each. */
const mostKnown = 16;

class View {
    /** @param number  of the scene
     * @param whole   wholeOf() */
    constructor(scene, number, whole) {
        this.scene = scene;
        this.number = number;
        this.whole = whole;
        this.count = Math.min(scene.count, scene.most);
        this.part = byId('part').content.firstElementChild.cloneNode(true);
        this.area = this.part.querySelector('.view');
        this.choice = this.part.querySelector('input');
        this.choice.value = number;
        this.part.querySelector('.name span').textContent = this.label();
        this.part.querySelectorAll('.corner').forEach(each => each.hidden = scene.most === 0);
        if (scene.differs) this.area.setAttribute('aria-label', `Before and after, ${this.label()}`);
        this.picture = new Picture(this.area.querySelector('canvas'), scene, whole);
        this.carved = new Uint8Array(scene.voxels);
        this.frame = null;
        /** carveSteps() of the frame, by count, the one shown last at the end. */
        this.known = new Map();
        /** VolumeView of all scenes; null without WebGL2. */
        this.volume = null;
        /** Its part of the volume's canvas: left, low, width and height, pixels. */
        this.pixels = [0, 0, 1, 1];
        this.forget();
    }
    /** What the scene differs in from the others: "type = seam.greedy". */
    label() { return (this.scene.differs ?? []).map(([target, value]) => `${target} = ${value}`).join(', '); }
    /** What makes this scene with the count chosen, for the command line. */
    setting() {
        const {scene} = this, count = [scene.setting, scene.signed(this.count)];
        const others = (scene.differs ?? []).filter(([target]) => scene.most === 0 || target !== scene.setting);
        return [...others, ...(scene.most > 0 ? [count] : [])].map(([target, value]) => `--set ${shellWord(`${target}=${value}`)}`).join(' ');
    }
    /** What was carved and tinted is no longer what is wanted. */
    forget() { this.carvedFor = this.tintedFor = ''; }
    /** Reads the frame nearest to a number. @returns what shows it */
    async show(number) {
        const read = await this.scene.frame(this.scene.nearest(number));
        read.outside ??= {of: contentOutside(read, this.scene.background)};
        return () => {
            this.frame = read;
            this.known.clear();
            this.forget();
            this.volume?.setBefore(this.number, read.volume);
        };
    }
    /** The carve of what is shown: of a slice, or of all voxels. @returns whether it is another one than before */
    carve(shown, at) {
        const {scene, frame, count, carved} = this, key = [frame.number, count, shown, shown === 'volume' ? '' : at].join(' ');
        if (key === this.carvedFor) return false;
        this.carvedFor = key;
        if (count === 0 && scene.sets.length < 2) {
            carved.set(frame.volume);
            return true;
        }
        const first = [0, 0, 0], last = scene.size.map(n => n - 1);
        if (shown !== 'volume') first[axisNumber[shown]] = last[axisNumber[shown]] = at;
        carve(frame.volume, scene.size, scene.background, frame.lattice, frame.places, this.steps(count), [first, last], carved);
        return true;
    }
    /** The steps of the frame shown for a count. Those of the counts last shown are kept: a slider goes back and forth. */
    steps(count) {
        const {scene, frame, known} = this, out = known.get(count) ?? carveSteps(scene.sets, count, scene.softness, frame.orders);
        known.delete(count);
        known.set(count, out);
        if (known.size > mostKnown) known.delete(known.keys().next().value);
        return out;
    }
    project(at, shown, turn) {
        return shown === 'volume' ? this.volume.project(this.number, at, turn, this.picture.canvas) : this.picture.project(shown, at, turn);
    }
    /** @param slice  place of the slice among those of the page
     * @param over    names of overlays */
    draw(shown, slice, turn, over, {wipe, brightness, colours}) {
        const {scene, frame, picture, carved} = this, at = shown === 'volume' ? 0 : this.whole.place(scene, axisNumber[shown], slice);
        const fresh = scene.most > 0 && this.carve(shown, at), tint = tinter(scene, frame, over, this.count), cut = scene.most > 0 ? wipe : 1;
        picture.clear();
        if (shown === 'volume') {
            if (fresh) this.volume.setAfter(this.number, carved);
            const key = [frame.number, [...over], over.has('seams') ? this.count : ''].join(' ');
            if (key !== this.tintedFor) {
                this.tintedFor = key;
                const bytes = tint && new Uint8Array(4 * scene.voxels);
                for (let n = 0; tint && n < scene.voxels; ++n) tint(n, bytes, 4 * n);
                this.volume.setOverlay(this.number, bytes);
            }
            this.volume.draw(this.number, this.pixels, turn, {wipe: cut, brightness, ground: channels(colours.ground), smoke: channels(colours.smoke)});
        } else {
            picture.drawSlice(shown, at, frame.volume, scene.most > 0 ? carved : frame.volume, tint, cut, turn, 2 ** brightness);
        }
        const project = place => this.project(place, shown, turn);
        if (frame.lattice && over.has('lattice')) {
            picture.drawLattice(frame.lattice, project, colours.line);
            picture.drawFolds(frame.lattice, frame.folds, project, colours);
        }
        if (frame.rig && over.has('rig')) picture.drawRig(frame.rig, project, colours.rig);
        if (frame.outside.of && over.has('outside'))
            picture.label(`${this.outsidePercent()} outside the lattice`, project(scene.placeOf(frame.outside.of.at)), colours);
        if (over.has('window') && this.atEdge() > 0) picture.label(this.edgeText(), project(this.edge()), colours);
        picture.drawWipe(cut, colours.accent);
    }
    outsidePercent() {
        const percent = 100 * this.frame.outside.of.share;
        return `${percent < 1 ? '< 1' : Math.round(percent)} %`;
    }
    /** Seams at an edge of the window, in this frame. */
    atEdge() {
        const {scene, frame} = this, [set] = scene.sets, [orders] = frame.orders;
        return scene.sets.length === 1 && set.window ? seamsAtEdge(set, orders[orders.length >> 1], this.count) : 0;
    }
    edgeText() { return `${this.atEdge()} ${this.atEdge() === 1 ? 'seam' : 'seams'} at the window's edge`; }
    /** The middle of the window's first edge, in voxels. */
    edge() {
        const [set] = this.scene.sets, at = set.shape.map(n => (n - 1) / 2);
        at[set.axis] = set.window[0];
        return this.frame.lattice.position(...at);
    }
    /** What is to be said of the frame shown: of each its style and text. */
    notes() {
        const {scene, frame} = this, folds = frame.folds ?? [], out = [];
        if (folds.length > 0)
            out.push(['bad', `${folds.length} cells of the lattice fold, from plane ${folds[0].k} on: shown in red. Make the lattice narrower, or its rig ` +
                'smoother.']);
        if (frame.outside.of)
            out.push(['', `${this.outsidePercent()} of ${scene.grid} lies outside the lattice and stays as it is. The overlay Outside shows where.`]);
        if (this.atEdge() > 0)
            out.push(['', `${this.edgeText()}: they may crop what lies there rather than carve it. The overlay Window shows where.`]);
        if (scene.sets.length === 0 && scene.lattices.length > 0) out.push(['', 'There are no seams yet: this is where the lattice lies.']);
        if (scene.step > 1) out.push(['',
            `Each voxel shows the mean of ${scene.step} x ${scene.step} x ${scene.step} voxels; the carve of the page reads these.`]);
        return out;
    }
    /** The value under a place of the pointer; a blank if there is none. @param slice  place of the slice among those of the page */
    valueAt(event, shown, slice, turn) {
        const {scene, frame, carved, picture} = this, area = picture.canvas.getBoundingClientRect(), ratio = picture.canvas.width / area.width;
        const pixel = [(event.clientX - area.left) * ratio, (event.clientY - area.top) * ratio];
        const at = frame && picture.voxelAt(shown, this.whole.place(scene, axisNumber[shown], slice), pixel, turn);
        if (!at) return '\u00a0';
        const n = at[0] + scene.size[0] * (at[1] + scene.size[1] * at[2]), text = byte => scene.value(byte).toPrecision(3);
        const index = at.map((x, axis) => scene.first[axis] + scene.step * x), world = scene.worldOf(at).map(x => x.toPrecision(4));
        return `${scene.grid} ${text(frame.volume[n])}` + (scene.most > 0 ? `, carved ${text(carved[n])}` : '') +
            (frame.energy ? `, energy ${(frame.energy[n] / 255 * scene.energyRange[1]).toPrecision(3)}` : '') +
            ` at voxel [${index.join(', ')}], world [${world.join(', ')}]`;
    }
}
