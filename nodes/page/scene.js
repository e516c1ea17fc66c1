'use strict';
// The data of the page, as page_scene (nodes/page/page_scene.h) writes it.

/** The bytes of a text of packed(): base64 of gzip. */
async function unpacked(text) {
    const packed = Uint8Array.from(atob(text), each => each.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes append_differences() of bytes. */
function summed(bytes) {
    const out = new Uint8Array(bytes.length);
    for (let n = 0, last = 0; n < bytes.length; ++n) out[n] = last = last + bytes[n] & 255;
    return out;
}

/** Undoes append_differences() of numbers of 16 bits. */
function summed16(bytes) {
    const out = new Uint16Array(bytes.length / 2);
    for (let n = 0, last = 0; n < out.length; ++n) out[n] = last = last + (bytes[n] | bytes[out.length + n] << 8) & 65535;
    return out;
}

/** The packed texts of a page, and what was made of them: scenes share both. */
class Packed {
    constructor(texts) {
        this.texts = texts;
        this.made = new Map();
    }
    /** What `make` makes of the bytes of text `n`; once for each `purpose`. */
    get(n, purpose, make) {
        const key = n + ' ' + purpose;
        if (!this.made.has(key)) this.made.set(key, unpacked(this.texts[n]).then(make));
        return this.made.get(key);
    }
}

class Scene {
    /** @param packed  Packed */
    constructor(data, packed) {
        Object.assign(this, data, {packed});
        this.voxels = this.size[0] * this.size[1] * this.size[2];
        this.most = this.sets.length > 0 ? this.sets[this.sets.length - 1].energies.length : 0;
        /** Lengths of a voxel along x, y and z, world units. */
        this.voxel = [1, 2, 3].map(n => Math.hypot(...minus(this.world[n], this.world[0])));
        this.kept = [];
    }
    /** The value that a byte stands for. */
    value(byte) { return this.range[0] + byte / 255 * (this.range[1] - this.range[0]); }
    worldOf(at) {
        return this.world[0].map((x, n) => x + [0, 1, 2].reduce((sum, axis) => sum + at[axis] * (this.world[axis + 1][n] - this.world[0][n]), 0));
    }
    /** The place of voxel `n` along x, y and z. */
    placeOf(n) { return [n % this.size[0], Math.floor(n / this.size[0]) % this.size[1], Math.floor(n / (this.size[0] * this.size[1]))]; }
    /** The sign and number of seams, as on the command line. */
    signed(count) {
        const set = this.sets[this.sets.length - 1];
        return count === 0 ? '0' : (set && set.kind === 'insert' ? '' : '-') + count;
    }
    /** The place in the list of frames of the one nearest to a frame number. */
    nearest(number) {
        const far = n => Math.abs(this.frames[n].number - number);
        return this.frames.reduce((best, _, n) => far(n) < far(best) ? n : best, 0);
    }
    /** A frame, ready to be carved. @param n  place in the list of frames */
    frame(n) { return this.kept[n] ??= this.read(this.frames[n]); }
    async read({number, lattice, rig, seams, voxels}) {
        const parts = await this.packed.get(voxels, 'voxels', bytes => {
            const out = [];
            for (let from = 0; from < bytes.length; from += this.voxels) out.push(summed(bytes.subarray(from, from + this.voxels)));
            return out;
        });
        let next = 0;
        const out = {number, rig: rig === null ? null : this.rigs[rig], volume: parts[next++]};
        out.energy = this.energyRange ? parts[next++] : null;
        out.masks = this.masks.map(() => parts[next++]);
        Object.assign(out, lattice === null ? {lattice: null} : await this.readLattice(this.lattices[lattice]));
        const orders = await Promise.all(seams.map(each => this.readSeams(this.seams[each])));
        out.orders = this.sets.map((set, s) => orders.map(order => order[s]));
        return out;
    }
    readLattice(data) {
        const {first, last} = reachOf(data, this.sets), purpose = JSON.stringify([data.shape, data.closed, data.around, data.box, this.size, first, last]);
        return this.packed.get(data.planes, purpose, bytes => {
            const lattice = new Lattice(data, new Float64Array(bytes.buffer));
            return {lattice, places: lattice.locate(this.size, first, last), folds: foldedCells(lattice)};
        });
    }
    /** Of each set, seamOrder(). */
    readSeams(n) {
        const purpose = JSON.stringify(this.sets.map(set => [set.axis, set.paired, set.shape, set.energies.length]));
        return this.packed.get(n, purpose, bytes => {
            const entries = summed16(bytes);
            let from = 0;
            return this.sets.map(set => {
                const size = (set.paired ? 2 : 1) * set.energies.length * columnsOf(set);
                return seamOrder(set, entries.subarray(from, from += size));
            });
        });
    }
    /** The number of seams from which on more of them hurt: where the energies lie deepest below the line from the first to the last; 0: none. */
    knee() {
        const set = this.sets[this.sets.length - 1], energies = set ? set.energies : [], last = energies.length - 1;
        let highest = -Infinity, deepest = 0, out = 0;
        const rising = energies.map(each => highest = Math.max(highest, each));
        rising.forEach((energy, n) => {
            const depth = rising[0] + (rising[last] - rising[0]) * n / last - energy;
            if (depth > deepest) deepest = depth, out = n + 1;
        });
        return out;
    }
}
