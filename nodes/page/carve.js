'use strict';
// The carve of remap.grids, in the page: seams as displacements (METHOD 4), and their smoothing (METHOD 10). Volumes are `[z][y][x]`, x
// fastest. Displacements are vertices; an inserted entry has a half.

/** The dimensions along which columns stand beside each other, and along which slices of them follow each other. */
const lateralOf = axis => axis === 0 ? 1 : 0, sliceOf = axis => axis === 2 ? 1 : 2;
const columnsOf = ({axis, shape}) => shape[lateralOf(axis)] * shape[sliceOf(axis)];

/** Which seam takes or doubles each entry in one frame: `[slice][lateral][entry]`, the number of the seam from 1 on; negative: of the pair's
 * window; 0: none.
 * @param entries  `[window][seam][slice][lateral]`, original entries */
function seamOrder(set, entries) {
    const before = set.shape[set.axis], columns = columnsOf(set), out = new Int16Array(columns * before);
    for (let window = 0, from = 0; window < (set.paired ? 2 : 1); ++window)
        for (let seam = 1; seam <= set.energies.length; ++seam)
            for (let column = 0; column < columns; ++column) out[column * before + entries[from++]] = window === 0 ? seam : -seam;
    return out;
}

/** One seam set in one frame, carved by its first `count` seams: CarveStep of carve/seam/carve_step.h. */
class CarveStep {
    /** @param origin  first vertex of the space before
     * @param soft, fade  vertices; 0: none
     * @param orders  seamOrder() of neighbouring frames: an odd number, this frame in the middle; one alone if time is not smoothed */
    constructor(set, count, origin, {soft, soft_time, fade}, orders) {
        this.axis = set.axis;
        this.lateralAxis = lateralOf(set.axis);
        this.sliceAxis = sliceOf(set.axis);
        this.inserts = set.kind === 'insert';
        this.closed = set.closed && set.axis !== 2;
        this.around = set.around;
        this.count = count;
        this.fade = fade;
        this.soft = soft > 0 || soft_time > 0;
        this.paired = set.paired;
        this.before = set.shape[set.axis];
        this.laterals = set.shape[this.lateralAxis];
        this.lastLateral = this.laterals - (set.around ? 0 : 1);  // around a rig column `laterals` is column 0 again
        this.slices = set.shape[this.sliceAxis];
        this.lastSlice = this.slices - (this.closed ? 0 : 1);
        this.firstLateral = origin[this.lateralAxis];
        this.firstSlice = origin[this.sliceAxis];
        this.origin = origin[set.axis];
        this.start = this.origin + set.shifts[count];
        this.growth = this.inserts ? count : -count;
        this.lastBefore = this.origin + this.before - 1;
        this.last = this.start + this.before + (set.paired ? 0 : this.growth) - 1;
        this.low = Math.min(this.origin, this.start);
        this.high = Math.max(this.lastBefore, this.last);
        this.entries = this.high - this.low + 1;
        // In which entries displacements change, by window; in this frame.
        this.seen = [[Infinity, -Infinity], [Infinity, -Infinity]];
        // The first and last entry at which they change in any frame.
        this.changed = [Infinity, -Infinity];
        const tables = orders.map((order, n) => this.displacements(order, 2 * n + 1 === orders.length));
        // Places in the table between which displacements change; beyond them all columns are alike.
        const reach = tent(soft).length - 1;
        this.begin = Math.max(0, this.changed[0] - 1 - reach - this.low);
        this.end = Math.min(this.entries, this.changed[1] + 2 + reach - this.low);
        this.table = this.soft ? this.smoothed(set, tables, soft, soft_time) : tables[0];  // `[slice][lateral][entry - low]`
    }

    /** Displacements by whole vertices. @param middle  whether this is the step's own frame */
    displacements(order, middle) {
        const out = new Float32Array(this.entries * this.laterals * this.slices), {before, count, inserts, start} = this, [one, pair] = this.seen;
        const whole = this.origin - start, head = start - this.low, behind = this.last - this.low;
        for (let column = 0, to = 0, of = 0; column < this.laterals * this.slices; ++column, to += this.entries, of += before) {
            const end = to + this.entries;
            let at = to, shift = whole;
            for (const first = to + head; at < first; ++at) out[at] = shift;
            for (let i = 0; i < before; ++i) {
                const seam = order[of + i];
                if (seam === 0 || seam > count || -seam > count) {
                    out[at++] = shift;
                    continue;
                }
                const doubles = seam > 0 === inserts, seen = seam > 0 ? one : pair;
                if (doubles) out[at++] = shift;
                const entry = at - to + this.low;
                if (middle && entry < seen[0]) seen[0] = entry;
                if (middle && entry > seen[1]) seen[1] = entry;
                if (entry < this.changed[0]) this.changed[0] = entry;
                if (entry > this.changed[1]) this.changed[1] = entry;
                if (doubles) out[at++] = shift - 0.5, --shift;
                else ++shift;
            }
            for (const last = out[to + behind]; at < end; ++at) out[at] = last;
        }
        return out;
    }

    /** The spans within which displacements change, and the displacements before and behind them: CarveStep::windows. */
    spans(set) {
        const {start, growth} = this, whole = this.origin - start;
        if (!this.paired) {
            const [first, last] = set.window ?? [this.around ? 1 : 0, this.before - 1];
            return [{first: start + first, last: start + last + growth, before: whole, behind: whole - growth}];
        }
        let [a, b] = this.seen;
        if (set.window && set.pair_window) {
            a = [start + set.window[0], start + set.window[1] + growth];
            b = [start + growth + set.pair_window[0], start + set.pair_window[1]];
        }
        return [{first: a[0], last: a[1], before: 0, behind: -growth}, {first: b[0], last: b[1], before: -growth, behind: 0}];
    }

    /** Displacements smoothed by a tent in space and time: SmoothDisplacement::soft. */
    smoothed(set, tables, soft, softTime) {
        const weights = tent(soft), reach = weights.length - 1, times = tent(softTime), {entries, low, begin, end} = this;
        const spans = this.spans(set), first = spans[0].first, last = spans[spans.length - 1].last;
        const now = tables.length === 1 ? tables[0] : overTime(tables, times);
        const [before, behind] = [spans[0].before, spans[spans.length - 1].behind];
        const parts = spans.map(span => {
            const first = span.first - low, size = span.last - span.first + 1, from = Math.max(begin, first), to = Math.min(end, first + size);
            // Of the line, what the sums read.
            const least = Math.max(0, from - first - reach), most = Math.min(size, to - first + reach);
            return {...span, first, size, from, count: to - from, least, most, line: new Float32Array(size + 2 * reach),
                starts: Int32Array.from({length: 2 * reach + 1}, (_, n) => from - first + n)};
        });
        for (let base = 0; base < now.length; base += entries) {
            for (let e = 0; e < first - low; ++e) now[base + e] = before;
            for (let e = last + 1 - low; e < entries; ++e) now[base + e] = behind;
            if (reach === 0) continue;
            // Spans of pairs may overlap: each is smoothed from what was before.
            for (const part of parts) {
                const {line, size, least, most} = part, from = base + part.first;
                for (let n = least; n < most; ++n) line[reach + n] = now[from + n];
                // Beyond a span the map goes on as its own mirror image.
                const below = least === 0 ? reach : 0, above = most === size ? reach : 0;
                for (let n = 1; n <= reach; ++n) {
                    if (n <= below) line[reach - n] = 2 * part.before - line[reach + n - 1];
                    if (n <= above) line[reach + size - 1 + n] = 2 * part.behind - line[reach + size - n];
                }
            }
            for (const {line, starts, count, from} of parts) sumRows(weights, line, starts, count, now, base + from, false);
        }
        if (reach === 0) return now;
        const size = end - begin, columns = this.laterals * this.slices, part = new Float32Array(columns * size), between = new Float32Array(part.length);
        for (let column = 0, to = 0; column < columns; ++column)
            for (let e = begin; e < end; ++e) part[to++] = now[column * entries + e];
        smoothAcross(part, weights, size, this.laterals, this.slices, this.around, false, between);
        smoothAcross(between, weights, size * this.laterals, this.slices, 1, this.closed, true, part);
        for (let column = 0, from = 0; column < columns; ++column)
            for (let e = begin; e < end; ++e) now[column * entries + e] = part[from++];
        return now;
    }

    /** How far content moves at a place in the table, vertices; NaN where values are blended, not positions.
     * @param e        from `low` to `high`
     * @param lateral, slice  from 0 to `lastLateral` and `lastSlice`: columns, from the first one on */
    displacement(e, lateral, slice) {
        const {table, entries, laterals, soft} = this, i = Math.floor(e), j = Math.floor(lateral), k = Math.floor(slice);
        const a = e - i, b = lateral - j, c = slice - k;
        const n = entries * (j + laterals * k) + i - this.low, d = table[n], whole = d === Math.floor(d);
        if (a + b + c === 0) return soft || whole ? d : NaN;
        // The four columns of the cell, and the next entry in each; those of weight 0 may not exist.
        const up = a > 0 ? 1 : 0, aside = b > 0 ? this.aside(j) : 0, behind = c > 0 ? this.behind(k) : 0;
        const n10 = n + aside, n01 = n + behind, n11 = n10 + behind;
        const d00 = d + (table[n + up] - d) * a, d10 = table[n10] + (table[n10 + up] - table[n10]) * a;
        const d01 = table[n01] + (table[n01 + up] - table[n01]) * a, d11 = table[n11] + (table[n11 + up] - table[n11]) * a;
        if (!soft && !(whole && d00 === d && d10 === d && d01 === d && d11 === d)) return NaN;
        const near = d00 + (d10 - d00) * b;
        return near + (d01 + (d11 - d01) * b - near) * c;
    }
    /** Whether displacements are known at a place, and the place is within the space after the step. */
    within(e, lateral, slice) { return e >= this.start && e <= this.last && e >= this.low && e <= this.high && this.holds(lateral, slice); }
    /** Whether the step has the columns around a place. */
    holds(lateral, slice) { return lateral >= 0 && lateral <= this.lastLateral && slice >= 0 && slice <= this.lastSlice; }
    /** Where all columns move alike, before and behind all seams: entries from `first` to `last`, and their displacement; none if `last` is less. */
    still() {
        const {table, low, begin, end, entries} = this, first = Math.max(this.start, low), last = Math.min(this.last, this.high);
        return [{first, last: low + begin - 1, d: table[Math.max(0, begin - 1)]}, {first: low + end, last, d: table[Math.min(end, entries - 1)]}];
    }
    /** A displacement that leads to an entry of the space before. */
    clamped(e, d) { return e + d < this.origin ? this.origin - e : e + d > this.lastBefore ? this.lastBefore - e : d; }
    /** From a column to the next one in `table`, laterally and to the next slice. */
    aside(j) { return this.entries * (j + 1 < this.laterals ? 1 : 1 - this.laterals); }
    behind(k) { return this.entries * this.laterals * (k + 1 < this.slices ? 1 : 1 - this.slices); }

    /** Factor of displacements, 0 to 1: CarveStep::rim_scale. @param lateral, slice  from the first column on */
    scale(lateral, slice) {
        if (this.fade === 0) return 1;
        const fromRim = (x, size) => size === 1 ? this.fade : Math.min(x, size - 1 - x);
        return Math.min(1, Math.min(this.around ? this.fade : fromRim(lateral, this.laterals), this.closed ? this.fade : fromRim(slice, this.slices)) / this.fade);
    }
}

/** Weights of a tent at distances 0 to ceil(reach); over both sides their sum is 1. Zeros follow, for sumRows(). */
function tent(reach) {
    const out = [];
    for (let x = 0; x <= Math.ceil(reach); ++x) out.push(1 - x / (reach + 1));
    const sum = 2 * out.reduce((all, each) => all + each, 0) - 1, weights = out.map(each => each / sum);
    while ((weights.length - 1) % 3 > 0) weights.push(0);
    return weights;
}

/** What is within 1e-4 of a whole number is that number. */
function nearWhole(x) {
    const whole = rounded(x);
    return Math.abs(x - whole) < 1e-4 ? whole : x;
}

function overTime(tables, weights) {
    const middle = (tables.length - 1) / 2, out = new Float32Array(tables[0].length);
    for (let e = 0; e < out.length; ++e) {
        let sum = 0;
        for (let n = 0; n < tables.length; ++n) sum += weights[Math.abs(n - middle)] * tables[n][e];
        out[e] = nearWhole(sum);
    }
    return out;
}

/** Writes the weighted sum of rows.
 * @param starts  where the rows begin in `from`, by distance, from the most negative one on
 * @param round   whether a sum near a whole number is that number */
function sumRows(weights, from, starts, size, out, to, round) {
    const reach = weights.length - 1, middle = starts[reach], w0 = weights[0];
    // Three distances at a time: mostly these are all.
    for (let i = 1; i <= reach; i += 3) {
        const w1 = weights[i], w2 = weights[i + 1], w3 = weights[i + 2], last = round && i + 2 === reach;
        const a1 = starts[reach - i], a2 = starts[reach - i - 1], a3 = starts[reach - i - 2];
        const b1 = starts[reach + i], b2 = starts[reach + i + 1], b3 = starts[reach + i + 2];
        if (i === 1)
            for (let e = 0; e < size; ++e) {
                const near = w0 * from[middle + e] + w1 * (from[a1 + e] + from[b1 + e]) + w2 * (from[a2 + e] + from[b2 + e]);
                const sum = near + w3 * (from[a3 + e] + from[b3 + e]);
                out[to + e] = last ? nearWhole(sum) : sum;
            }
        else
            for (let e = 0; e < size; ++e) {
                const sum = out[to + e] + w1 * (from[a1 + e] + from[b1 + e]) + w2 * (from[a2 + e] + from[b2 + e]) + w3 * (from[a3 + e] + from[b3 + e]);
                out[to + e] = last ? nearWhole(sum) : sum;
            }
    }
}

/** Smooths rows of `row` values over their neighbours. @param table  `[line][row]`: `lines` times `count` rows
 * @param round  whether a value near a whole number is that number */
function smoothAcross(table, weights, row, count, lines, closed, round, out) {
    const reach = weights.length - 1, starts = new Int32Array(2 * reach + 1);
    for (let line = 0; line < lines; ++line)
        for (let at = 0, rows = 1; at < count; at += rows) {
            // Rows whose neighbours all lie in the line are summed in one go.
            rows = at >= reach && at + reach < count ? count - reach - at : 1;
            for (let i = -reach; i <= reach; ++i)
                starts[reach + i] = row * (line * count + (closed ? (((at + i) % count) + count) % count : clamp(at + i, 0, count - 1)));
            sumRows(weights, table, starts, rows * row, out, row * (line * count + at), round);
        }
}

/** The steps of a chain of seam sets in one frame: CarveMap. @param count  seams used of the last set; of all others, all
 * @param orders  `[set][neighbouring frame]` */
function carveSteps(sets, count, softness, orders) {
    const origin = [0, 0, 0], steps = [];
    sets.forEach((set, n) => {
        const used = n + 1 === sets.length ? count : set.energies.length;
        if (used === 0) return;
        const step = new CarveStep(set, used, origin, softness, orders[n]);
        origin[set.axis] = step.start;
        steps.push(step);
    });
    return steps;
}

/** Carves a volume of 8 bits. Reads between voxels linearly; beyond the volume lies `background`.
 * @param places  Lattice.locate()
 * @param box     [[x, y, z], [x, y, z]]: first and last voxel to carve
 * @param out     receives the carved voxels of the box */
function carve(volume, size, background, lattice, places, steps, box, out) {
    const [nx, ny, nz] = size, row = nx, plane = nx * ny;
    const valueAt = (x, y, z) => x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz ? volume[x + row * y + plane * z] : background;
    const readAtRim = (i, j, k, a, b, c) => {
        let sum = 0;
        for (let n = 0; n < 8; ++n) {
            const weight = (n & 1 ? a : 1 - a) * (n & 2 ? b : 1 - b) * (n & 4 ? c : 1 - c);
            if (weight > 0) sum += weight * valueAt(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
        }
        return sum;
    };
    const read = (x, y, z) => {
        // What is near a voxel is that voxel: snapped(), for positions in one go.
        let i = Math.floor(x + snapWidth), j = Math.floor(y + snapWidth), k = Math.floor(z + snapWidth);
        const a = x - i > snapWidth ? x - i : 0, b = y - j > snapWidth ? y - j : 0, c = z - k > snapWidth ? z - k : 0;
        if (i < 0 || j < 0 || k < 0 || i + 1 >= nx || j + 1 >= ny || k + 1 >= nz) return readAtRim(i, j, k, a, b, c);
        const n = i + row * j + plane * k, v0 = volume[n];
        if (b === 0 && c === 0) return a === 0 ? v0 : v0 + (volume[n + 1] - v0) * a;
        const v1 = volume[n + 1], v2 = volume[n + row], v3 = volume[n + row + 1];
        const x0 = v0 + (v1 - v0) * a, low = x0 + (v2 + (v3 - v2) * a - x0) * b;
        if (c === 0) return low;
        const m = n + plane, v4 = volume[m], v5 = volume[m + 1], v6 = volume[m + row], v7 = volume[m + row + 1];
        const x2 = v4 + (v5 - v4) * a, high = x2 + (v6 + (v7 - v6) * a - x2) * b;
        return low + (high - low) * c;
    };

    let px = 0, py = 0, pz = 0, voxel = 0;           // the voxel's place, and its number
    const {steps: shears, box: straight} = lattice;  // the steps to the next vertex along u and v, per plane
    /** The content at displacements from the voxel's own place. Along u and v they move it straight in the plane at `w`. */
    const content = (alongU, alongV, alongW, w) => {
        if (alongU === 0 && alongV === 0 && alongW === 0) return volume[voxel];
        if (alongW !== 0) {
            const here = lattice.position(places[3 * voxel], places[3 * voxel + 1], w);
            const there = lattice.position(places[3 * voxel] + alongU, places[3 * voxel + 1] + alongV, w + alongW);
            return read(px + there[0] - here[0], py + there[1] - here[1], pz + there[2] - here[2]);
        }
        let du = alongU, dv = alongV;
        if (lattice.around) {
            const u = places[3 * voxel], v = places[3 * voxel + 1];
            [du, dv] = minus2(lattice.across(u + du, v + dv), lattice.across(u, v));
        }
        const k = straight ? 0 : Math.floor(w + lattice.before), c = straight ? 0 : w + lattice.before - k, n = 6 * k;
        let x = du * shears[n] + dv * shears[n + 3], y = du * shears[n + 1] + dv * shears[n + 4], z = du * shears[n + 2] + dv * shears[n + 5];
        if (c > 0) {
            x += c * (du * shears[n + 6] + dv * shears[n + 9] - x);
            y += c * (du * shears[n + 7] + dv * shears[n + 10] - y);
            z += c * (du * shears[n + 8] + dv * shears[n + 11] - z);
        }
        return read(px + x, py + y, pz + z);
    };

    /** The content at lattice coordinates after the first `count` steps. */
    const gather = (count, u, v, w) => {
        while (count-- > 0) {
            const step = steps[count], {axis} = step, lateral = (axis === 0 ? v : u) - step.firstLateral, slice = (axis === 2 ? v : w) - step.firstSlice;
            let e = axis === 0 ? u : axis === 1 ? v : w;
            if (e > step.high && e <= step.high + rimSlack) e = step.high;
            if (e < step.low && e >= step.low - rimSlack) e = step.low;
            if (e < step.low || e > step.high || !step.holds(lateral, slice)) continue;
            const scale = step.fade === 0 ? 1 : step.scale(lateral, slice);
            if (e < step.origin + scale * (step.start - step.origin) || e > step.lastBefore + scale * (step.last - step.lastBefore)) {
                if (step.inserts) continue;
                return background;
            }
            const d = step.displacement(e, lateral, slice);
            if (d === d) {
                const to = clamp(e + scale * d, step.origin, step.lastBefore);
                if (axis === 0) u = to;
                else if (axis === 1) v = to;
                else w = to;
                continue;
            }
            // Beside a seam values are blended, not positions.
            const goTo = to => {
                if (scale < 1) to = clamp(e + scale * (to - e), step.origin, step.lastBefore);
                return axis === 0 ? gather(count, to, v, w) : axis === 1 ? gather(count, u, to, w) : gather(count, u, v, to);
            };
            // An inserted entry is the mean of its neighbours.
            const from = (entry, by) => Number.isInteger(by) ? goTo(entry + by) : 0.5 * (goTo(entry + by - 0.5) + goTo(entry + by + 0.5));
            const {table, entries} = step, i = Math.floor(e), j = Math.floor(lateral), k = Math.floor(slice), a = e - i, b = lateral - j, c = slice - k;
            const n = entries * (j + step.laterals * k) + i - step.low, up = a > 0 ? 1 : 0;
            const aside = n + (b > 0 ? step.aside(j) : 0), behind = c > 0 ? step.behind(k) : 0;
            const column = n => table[n] === table[n + up] ? from(e, table[n]) : (1 - a) * from(i, table[n]) + a * from(i + 1, table[n + up]);
            let sum = (1 - b) * (1 - c) * column(n);
            if (b > 0) sum += b * (1 - c) * column(aside);
            if (c > 0) sum += (1 - b) * c * column(n + behind);
            if (b > 0 && c > 0) sum += b * c * column(aside + behind);
            return sum;
        }
        return content(u - places[3 * voxel], v - places[3 * voxel + 1], w - places[3 * voxel + 2], places[3 * voxel + 2]);
    };

    /** The content of voxel `n` at x, y and z of `at`. */
    const gathered = (at, n) => {
        px = at[0], py = at[1], pz = at[2], voxel = n;
        return gather(steps.length, places[3 * n], places[3 * n + 1], places[3 * n + 2]);
    };
    /** The same, if it lies so many vertices further along an axis. */
    const shifted = (at, n, axis, by) => {
        px = at[0], py = at[1], pz = at[2], voxel = n;
        return content(axis === 0 ? by : 0, axis === 1 ? by : 0, axis === 2 ? by : 0, places[3 * n + 2]);
    };
    // Most volumes are carved by one step.
    const one = steps.length === 1 && steps[0].fade === 0 ? steps[0] : null;
    const along = one && straight && !lattice.around ? lattice.stepAlong(one.axis) : [0, 0, 0], lines = [0, 1, 2].filter(n => along[n] !== 0);
    if (lines.length === 1) return carveLines(volume, size, places, one, lines[0], along[lines[0]], box, out, gathered, shifted);
    const at = [0, 0, 0];
    for (let z = box[0][2]; z <= box[1][2]; ++z)
        for (let y = box[0][1]; y <= box[1][1]; ++y)
            for (let x = box[0][0], n = x + row * y + plane * z; x <= box[1][0]; ++x, ++n) {
                if (places[3 * n] !== places[3 * n]) {
                    out[n] = volume[n];
                    continue;
                }
                at[0] = x, at[1] = y, at[2] = z;
                // Most cells move as one.
                const e = one ? places[3 * n + one.axis] : NaN, lateral = one ? places[3 * n + one.lateralAxis] - one.firstLateral : NaN;
                const slice = one ? places[3 * n + one.sliceAxis] - one.firstSlice : NaN;
                const d = one && one.within(e, lateral, slice) ? one.displacement(e, lateral, slice) : NaN;
                out[n] = (d === d ? shifted(at, n, one.axis, one.clamped(e, d)) : gathered(at, n)) + 0.5;
            }
}

/** carve() by one step that moves all content along one line of voxels, as in a box along the voxels. What closures hold is slow, so that the loop
 * has all that it needs of its own.
 * @param line       0, 1 or 2: along x, y or z
 * @param perVertex  voxels from a vertex to the next one, along the line
 * @param gathered, shifted  those of carve() */
function carveLines(volume, size, places, step, line, perVertex, box, out, gathered, shifted) {
    const {axis, low, origin, lastBefore, laterals, entries, table, soft} = step;
    const least = Math.max(step.start, low), most = Math.min(step.last, step.high);
    const strides = [1, size[0], size[0] * size[1]], stride = strides[line], end = size[line] - 1 - snapWidth, stop = box[1][line], at = [0, 0, 0];
    const [lower, upper] = step.still();
    const [p, q] = [0, 1, 2].filter(n => n !== line);
    for (let i = box[0][q]; i <= box[1][q]; ++i)
        for (let j = box[0][p]; j <= box[1][p]; ++j) {
            at[q] = i, at[p] = j;
            let m = box[0][line], n = strides[q] * i + strides[p] * j + stride * m;
            for (; m <= stop && places[3 * n] !== places[3 * n]; ++m, n += stride) out[n] = volume[n];
            if (m > stop) continue;
            // All voxels of a line lie beside the same columns.
            const lateral = places[3 * n + step.lateralAxis] - step.firstLateral, slice = places[3 * n + step.sliceAxis] - step.firstSlice;
            const within = step.holds(lateral, slice), aligned = within && lateral === Math.floor(lateral) && slice === Math.floor(slice);
            const column = aligned ? entries * (lateral + laterals * slice) : 0;
            for (; m <= stop; ++m, n += stride) {
                const e = places[3 * n + axis];
                if (e !== e) {
                    out[n] = volume[n];
                    continue;
                }
                const part = e <= lower.last ? lower : upper;
                if (within && e >= part.first && e <= part.last) {
                    const moved = part.d * perVertex, whole = Math.floor(moved + snapWidth), f = moved - whole, from = stride * whole;
                    // All up to this voxel moves alike.
                    const far = Math.min(stop, m + Math.floor(((perVertex > 0 ? part.last : part.first) - e) * perVertex), Math.ceil(end - moved) - 1);
                    const to = n + stride * (far - m);
                    if (m + moved >= 0 && to >= n && places[3 * to] === places[3 * to]) {
                        if (f > snapWidth)
                            for (let each = n; each <= to; each += stride) {
                                const here = volume[each + from];
                                out[each] = here + (volume[each + from + stride] - here) * f + 0.5;
                            }
                        else
                            for (let each = n; each <= to; each += stride) out[each] = volume[each + from];
                        m = far;
                        n = to;
                        continue;
                    }
                }
                let d = NaN;
                if (e >= least && e <= most) {
                    const entry = e - low | 0, here = table[column + entry];
                    if (!aligned || e - low !== entry) d = within ? step.displacement(e, lateral, slice) : NaN;
                    else if (soft || here === Math.floor(here)) d = here;
                }
                const to = e + d, by = to < origin ? origin - e : to > lastBefore ? lastBefore - e : d, place = m + by * perVertex;
                if (place >= 0 && place < end) {
                    const below = place + snapWidth | 0, f = place - below, there = n + stride * (below - m), here = volume[there];
                    out[n] = (f > snapWidth ? here + (volume[there + stride] - here) * f : here) + 0.5;
                } else {
                    at[line] = m;
                    out[n] = (d === d ? shifted(at, n, axis, by) : gathered(at, n)) + 0.5;
                }
            }
        }
}
