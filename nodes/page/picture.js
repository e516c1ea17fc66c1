'use strict';
// What is drawn on the 2D canvas: slices, and over all views the lattice, its folded cells and the rig.

/** Axes of right and up in a slice across an axis, as preview.sheet has them. */
const sliceAxes = {x: [1, 2], y: [0, 2], z: [0, 1]};
const axisNumber = {x: 0, y: 1, z: 2};

/** The box around all scenes of a page. Lengths are world units along x, y and z. */
function wholeOf(scenes) {
    const low = [0, 1, 2].map(n => Math.min(...scenes.map(({first}) => first[n])));
    const high = [0, 1, 2].map(n => Math.max(...scenes.map(({first, step, size}) => first[n] + step * size[n])));
    const step = Math.min(...scenes.map(each => each.step)), voxel = scenes[0].voxel.map(length => length / scenes[0].step);
    return {
        low, step, lengths: voxel.map((length, n) => length * (high[n] - low[n])),
        /** Slices across each axis. */
        slices: low.map((x, n) => Math.ceil((high[n] - x) / step)),
        /** The place of a slice in a scene, in its voxels. */
        place: (scene, axis, at) => clamp(Math.floor((low[axis] + step * at - scene.first[axis]) / scene.step), 0, scene.size[axis] - 1),
        /** From the middle of the box to that of a scene. */
        offset: ({first, step, size}) => first.map((x, n) => voxel[n] * (x + step * size[n] / 2 - (low[n] + high[n]) / 2))};
}

/** Colours of overlays: red, green, blue. */
const tints = {energy: [230, 120, 40], seams: [0, 190, 200], masks: [200, 60, 180], window: [90, 170, 80], outside: [230, 60, 50]};

/** Tints voxels of `before`: writes red, green, blue and strength (0 to 255) of voxel `n` at `to`. A seam covers a mask, a mask the energy.
 * @param shown  names of overlays
 * @returns null if nothing is shown */
function tinter(scene, frame, shown, count) {
    const {places} = frame, set = scene.sets[0], order = set && scene.sets.length === 1 && frame.orders[0][frame.orders[0].length >> 1];
    const seams = shown.has('seams') && order && count > 0, window = shown.has('window') && set && set.window;
    const energy = shown.has('energy') && frame.energy, masks = shown.has('masks') ? frame.masks : [], outside = shown.has('outside') && places;
    if (!seams && !window && !energy && !outside && masks.length === 0) return null;
    const {axis, shape} = set ?? {axis: 0, shape: [1, 1, 1]}, before = shape[axis], laterals = shape[lateralOf(axis)], slices = shape[sliceOf(axis)];
    const windows = window ? [set.window, ...(set.pair_window ? [set.pair_window] : [])] : [];
    const paint = (out, to, [red, green, blue], strength) => {
        out[to] = red;
        out[to + 1] = green;
        out[to + 2] = blue;
        out[to + 3] = strength;
    };
    return (n, out, to) => {
        out[to + 3] = 0;
        const u = places ? places[3 * n] : NaN;
        if (outside && u !== u) return paint(out, to, tints.outside, Math.min(200, 3 * Math.abs(frame.volume[n] - scene.background)));
        if (u === u && set) {
            const at = dimension => Math.round(places[3 * n + dimension]), entry = at(axis), lateral = at(lateralOf(axis)) % (set.around ? laterals : Infinity);
            if (entry >= 0 && entry < before && lateral >= 0 && lateral < laterals) {
                const seam = seams ? Math.abs(order[((at(sliceOf(axis)) % slices) * laterals + lateral) * before + entry]) : 0;
                if (seam > 0 && seam <= count) return paint(out, to, tints.seams, 200);
                for (const [first, last] of windows)
                    if (entry >= first && entry <= last) paint(out, to, tints.window, 60);
            }
        }
        for (const mask of masks)
            if (mask[n] > 127) return paint(out, to, tints.masks, 150);
        if (energy && energy[n] > 0) paint(out, to, tints.energy, energy[n] * 0.85);
    };
}

class Picture {
    /** @param whole  around all scenes of the page (wholeOf) */
    constructor(canvas, scene, whole) {
        this.canvas = canvas;
        this.context = canvas.getContext('2d');
        this.scene = scene;
        this.whole = whole;
        this.slice = document.createElement('canvas');
    }
    clear() { this.context.clearRect(0, 0, this.canvas.width, this.canvas.height); }

    /** Where a slice stands: the pixel of its low left corner, and pixels per voxel along right and up. */
    layout(axis, {zoom, pan}) {
        const {width, height} = this.canvas, {size, voxel} = this.scene, [r, t] = sliceAxes[axis], lengths = this.whole.lengths;
        const scale = zoom * Math.min(width * 0.94 / lengths[r], height * 0.94 / lengths[t]), from = this.whole.offset(this.scene);
        const x = scale * voxel[r], y = scale * voxel[t];
        const left = Math.round((width - x * size[r]) / 2 + scale * from[r] + pan[0] * width);
        return {left, low: Math.round((height + y * size[t]) / 2 - scale * from[t] + pan[1] * height), x, y};
    }
    /** The voxel under a pixel of the canvas; null beyond the slice. */
    voxelAt(axis, at, pixel, view) {
        const {left, low, x, y} = this.layout(axis, view), [r, t] = sliceAxes[axis], out = [0, 0, 0], {size} = this.scene;
        out[axisNumber[axis]] = at;
        out[r] = Math.floor((pixel[0] - left) / x);
        out[t] = Math.floor((low - pixel[1]) / y);
        return out[r] >= 0 && out[t] >= 0 && out[r] < size[r] && out[t] < size[t] ? out : null;
    }
    /** The pixel in the middle of a place in voxels. */
    project(axis, at, view) {
        const {left, low, x, y} = this.layout(axis, view), [r, t] = sliceAxes[axis];
        return [left + (at[r] + 0.5) * x, low - (at[t] + 0.5) * y];
    }
    /** Draws a slice: `before` to the left of the wipe, `after` to the right.
     * @param tint  tinter() */
    drawSlice(axis, at, before, after, tint, wipe, view, exposure) {
        const {size} = this.scene, [r, t] = sliceAxes[axis], stride = [1, size[0], size[0] * size[1]], {slice, context} = this;
        slice.width = size[r];
        slice.height = size[t];
        const {left, low, x, y} = this.layout(axis, view), pixels = new ImageData(size[r], size[t]), over = new Uint8Array(4);
        const draw = (volume, tinted, from, to) => {
            for (let up = 0, p = 4 * size[r] * (size[t] - 1); up < size[t]; ++up, p -= 8 * size[r])
                for (let right = 0; right < size[r]; ++right, p += 4) {
                    const n = at * stride[axisNumber[axis]] + right * stride[r] + up * stride[t], grey = Math.min(255, volume[n] * exposure);
                    const part = tinted ? (tinted(n, over, 0), over[3] / 255) : 0;
                    for (let c = 0; c < 3; ++c) pixels.data[p + c] = grey + (over[c] - grey) * part;
                    pixels.data[p + 3] = 255;
                }
            slice.getContext('2d').putImageData(pixels, 0, 0);
            context.save();
            context.beginPath();
            context.rect(from, 0, to - from, this.canvas.height);
            context.clip();
            context.imageSmoothingEnabled = false;
            context.drawImage(slice, left, low - y * size[t], x * size[r], y * size[t]);
            context.restore();
        };
        const edge = Math.round(wipe * this.canvas.width);
        draw(before, tint, 0, edge);
        draw(after, null, edge, this.canvas.width);
    }
    /** Draws the line between before and after. */
    drawWipe(wipe, colour) {
        const x = Math.round(wipe * this.canvas.width) + 0.5;
        if (wipe > 0 && wipe < 1) this.line([[x, 0], [x, this.canvas.height]], colour, 1.5);
    }
    line(points, colour, width) {
        const {context} = this;
        context.beginPath();
        points.forEach(([x, y], n) => n === 0 ? context.moveTo(x, y) : context.lineTo(x, y));
        context.strokeStyle = colour;
        context.lineWidth = width * (window.devicePixelRatio || 1);
        context.stroke();
    }
    /** The outlines of about 16 planes, and four lines along them: through their corners, or around a rig on four sides.
     * @param project  place in voxels to pixel */
    drawLattice(lattice, project, colour) {
        const [lastU, lastV] = [lattice.shape[0] - 1, lattice.shape[1] - 1], planes = lattice.shape[2], step = Math.max(1, Math.ceil(planes / 16));
        const quarter = lattice.shape[1] / 4, round = Array.from({length: lattice.shape[1]}, (_, v) => [lastU, v]);
        const corners = lattice.around ? [0, 1, 2, 3].map(n => [lastU, n * quarter]) : [[0, 0], [lastU, 0], [lastU, lastV], [0, lastV]];
        const rim = lattice.around ? round : corners;
        const outline = k => this.line([...rim, rim[0]].map(([u, v]) => project(lattice.position(u, v, k))), colour, 1);
        for (let k = 0; k < planes; k += step) outline(k);
        if (!lattice.closed && (planes - 1) % step !== 0) outline(planes - 1);
        const ends = Array.from({length: planes + (lattice.closed ? 1 : 0)}, (_, k) => k);
        for (const [u, v] of corners) this.line(ends.map(k => project(lattice.position(u, v, k))), colour, 1);
    }
    /** Folded cells, and a label at the first of them. */
    drawFolds(lattice, cells, project, colours) {
        for (const {k, i, j} of cells.slice(0, 4000)) {
            const far = [Math.min(i + 1, lattice.shape[0] - 1), lattice.around ? j + 1 : Math.min(j + 1, lattice.shape[1] - 1)];
            for (const w of [k, k + 1])
                this.line([[i, j], [far[0], j], far, [i, far[1]], [i, j]].map(([u, v]) => project(lattice.position(u, v, w))), colours.bad, 1);
        }
        if (cells.length > 0) this.label(`${cells.length} folded ${cells.length === 1 ? 'cell' : 'cells'}`,
            project(lattice.position(cells[0].i, cells[0].j, cells[0].k)), colours);
    }
    /** A warning at its place in the picture. */
    label(text, [x, y], {bad, page}) {
        const {context} = this, ratio = window.devicePixelRatio || 1;
        context.font = `600 ${13 * ratio}px system-ui, sans-serif`;
        const wide = context.measureText(text).width + 12 * ratio, left = clamp(x + 8 * ratio, 0, this.canvas.width - wide);
        const top = clamp(y - 26 * ratio, 0, this.canvas.height - 22 * ratio);
        context.fillStyle = bad;
        context.fillRect(left, top, wide, 22 * ratio);
        context.fillStyle = page;
        context.fillText(text, left + 6 * ratio, top + 16 * ratio);
    }
    drawRig({points, closed}, project, colour) {
        const all = [];
        for (let n = 0; n < points.length; n += 3) all.push(project(points.slice(n, n + 3)));
        this.line(closed ? [...all, all[0]] : all, colour, 2);
    }
}
