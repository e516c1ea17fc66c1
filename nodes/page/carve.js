'use strict';
// The carve of remap.grids, in the page: seams as displacements (METHOD 4), and their smoothing (METHOD 10). Volumes are `[z][y][x]`, x
// fastest. Displacements are vertices; an inserted entry has a half.

/** Which seam takes or doubles each entry in one frame: `[k][lateral][entry]`, the number of the seam from 1 on; negative: of the pair's
 * window; 0: none.
 * @param entries  `[window][seam][k][lateral]`, original entries */
function seamOrder(set, entries) {
    const before = set.shape[set.axis], columns = set.shape[1 - set.axis] * set.shape[2], out = new Int16Array(columns * before);
    for (let window = 0, from = 0; window < (set.paired ? 2 : 1); ++window)
        for (let seam = 1; seam <= set.energies.length; ++seam)
            for (let column = 0; column < columns; ++column) out[column * before + entries[from++]] = window === 0 ? seam : -seam;
    return out;
}

/** One seam set in one frame, carved by its first `count` seams: CarveStep of nodes/seams/carve_step.h. */
class CarveStep {
    /** @param origin  first entry of the space before, along u and v
     * @param soft, fade  vertices; 0: none
     * @param orders  seamOrder() of neighbouring frames: an odd number, this frame in the middle; one alone if time is not smoothed */
    constructor(set, count, origin, {soft, soft_time, fade}, orders) {
        this.axis = set.axis;
        this.inserts = set.kind === 'insert';
        this.closed = set.closed;
        this.around = set.around;
        this.count = count;
        this.fade = fade;
        this.soft = soft > 0 || soft_time > 0;
        this.paired = set.paired;
        this.before = set.shape[set.axis];
        this.laterals = set.shape[1 - set.axis];
        this.lastLateral = this.laterals - (set.around ? 0 : 1);  // around a rig column `laterals` is column 0 again
        this.slices = set.shape[2];
        this.firstLateral = origin[1 - set.axis];
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
        const tables = orders.map((order, n) => this.displacements(order, 2 * n + 1 === orders.length));
        this.table = this.soft ? this.smoothed(set, tables, soft, soft_time) : tables[0];  // `[k][lateral][entry - low]`
    }

    /** Displacements by whole vertices. @param middle  whether this is the step's own frame */
    displacements(order, middle) {
        const out = new Float32Array(this.entries * this.laterals * this.slices), {before, count, inserts, origin} = this;
        for (let column = 0; column < this.laterals * this.slices; ++column) {
            const base = column * this.entries - this.low, of = column * before;
            let entry = this.start;
            out.fill(origin - this.start, column * this.entries, base + entry);
            for (let i = 0; i < before; ++i) {
                const seam = order[of + i];
                if (seam === 0 || seam > count || -seam > count) {
                    out[base + entry] = origin + i - entry++;
                    continue;
                }
                const doubles = seam > 0 === inserts;
                if (doubles) out[base + entry] = origin + i - entry++;
                if (middle) {
                    const seen = this.seen[seam > 0 ? 0 : 1];
                    seen[0] = Math.min(seen[0], entry);
                    seen[1] = Math.max(seen[1], entry);
                }
                if (doubles) out[base + entry] = origin + i + 0.5 - entry++;
            }
            out.fill(out[base + this.last], base + this.last + 1, (column + 1) * this.entries);
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
        const weights = tent(soft), reach = weights.length - 1, times = tent(softTime), {entries, low} = this;
        const spans = this.spans(set), first = spans[0].first, last = spans[spans.length - 1].last;
        const now = tables.length === 1 ? tables[0] : overTime(tables, times);
        const line = new Float32Array(entries + 2 * reach), sharp = new Float32Array(entries), along = Int32Array.from({length: 2 * reach + 1}, (_, n) => n),
            [before, behind] = [spans[0].before, spans[spans.length - 1].behind];
        for (let base = 0; base < now.length; base += entries) {
            now.fill(before, base, base + Math.max(0, first - low));
            now.fill(behind, base + last + 1 - low, base + entries);
            if (reach === 0) continue;
            // Spans of pairs may overlap: each is smoothed from what was before.
            sharp.set(now.subarray(base, base + entries));
            for (const span of spans) {
                const size = span.last - span.first + 1, from = span.first - low;
                for (let n = 0; n < size; ++n) line[reach + n] = sharp[from + n];
                // Beyond a span the map goes on as its own mirror image.
                for (let n = 1; n <= reach; ++n) {
                    line[reach - n] = mirrored(sharp, from, size, -n, span);
                    line[reach + size - 1 + n] = mirrored(sharp, from, size, size - 1 + n, span);
                }
                sumRows(weights, line, along, size, now, base + from, false);
            }
        }
        if (reach === 0) return now;
        const across = smoothAcross(now, weights, entries, this.laterals, this.slices, entries, entries * this.laterals, this.around, false);
        return smoothAcross(across, weights, entries, this.slices, this.laterals, entries * this.laterals, entries, this.closed, true);
    }

    /** Factor of displacements, 0 to 1: CarveStep::scale. @param lateral  from the first column on */
    scale(lateral, w) {
        if (this.fade === 0) return 1;
        const fromRim = (x, size) => size === 1 ? this.fade : Math.min(x, size - 1 - x);
        return Math.min(1, Math.min(this.around ? this.fade : fromRim(lateral, this.laterals), this.closed ? this.fade : fromRim(w, this.slices)) / this.fade);
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

/** A displacement of a column whose span is mirrored half a vertex beyond its ends. @param n  entry, from the span's first */
function mirrored(table, from, size, n, span) {
    let add = 0, sign = 1;
    while (n < 0 || n >= size) {
        add += sign * 2 * (n < 0 ? span.before : span.behind);
        sign = -sign;
        n = n < 0 ? -1 - n : 2 * size - 1 - n;
    }
    return add + sign * table[from + n];
}

/** Writes the weighted sum of rows.
 * @param starts  where the rows begin in `from`, by distance, from the most negative one on
 * @param round   whether a sum near a whole number is that number */
function sumRows(weights, from, starts, size, out, to, round) {
    const reach = weights.length - 1, middle = starts[reach], w0 = weights[0];
    // Three distances at a time: mostly these are all.
    for (let i = 1; i <= reach; i += 3) {
        const w1 = weights[i], w2 = weights[i + 1], w3 = weights[i + 2], first = i === 1;
        const a1 = starts[reach - i], a2 = starts[reach - i - 1], a3 = starts[reach - i - 2];
        const b1 = starts[reach + i], b2 = starts[reach + i + 1], b3 = starts[reach + i + 2];
        for (let e = 0; e < size; ++e)
            out[to + e] = (first ? w0 * from[middle + e] : out[to + e]) + w1 * (from[a1 + e] + from[b1 + e]) + w2 * (from[a2 + e] + from[b2 + e]) +
                w3 * (from[a3 + e] + from[b3 + e]);
    }
    for (let e = to; round && e < to + size; ++e) out[e] = nearWhole(out[e]);
}

/** Smooths whole columns over their neighbours in lines of `count`, `stride` apart; lines stand `between` apart. */
function smoothAcross(table, weights, entries, count, lines, stride, between, closed, round) {
    const out = new Float32Array(table.length), reach = weights.length - 1, starts = new Int32Array(2 * reach + 1);
    for (let line = 0; line < lines; ++line)
        for (let at = 0; at < count; ++at) {
            const base = line * between;
            for (let i = -reach; i <= reach; ++i)
                starts[reach + i] = base + stride * (closed ? (((at + i) % count) + count) % count : clamp(at + i, 0, count - 1));
            sumRows(weights, table, starts, entries, out, base + at * stride, round);
        }
    return out;
}

/** The steps of a chain of seam sets in one frame: CarveMap. @param count  seams used of the last set; of all others, all
 * @param orders  `[set][neighbouring frame]` */
function carveSteps(sets, count, softness, orders) {
    const origin = [0, 0], steps = [];
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
    const voxel = (x, y, z) => x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz ? volume[x + row * y + plane * z] : background;
    const readAtRim = (i, j, k, a, b, c) => {
        let sum = 0;
        for (let n = 0; n < 8; ++n) {
            const weight = (n & 1 ? a : 1 - a) * (n & 2 ? b : 1 - b) * (n & 4 ? c : 1 - c);
            if (weight > 0) sum += weight * voxel(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
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

    let px = 0, py = 0, pz = 0, pu = 0, pv = 0;      // the voxel, and its place along u and v
    const {steps: shears, box: straight} = lattice;  // the steps to the next vertex along u and v, per plane
    /** The content at displacements from the voxel's own place: both move it straight in the plane at `w`. */
    const content = (alongU, alongV, w) => {
        if (alongU === 0 && alongV === 0) return volume[px + row * py + plane * pz];
        let du = alongU, dv = alongV;
        if (lattice.around) [du, dv] = minus2(lattice.across(pu + du, pv + dv), lattice.across(pu, pv));
        const k = straight ? 0 : Math.floor(w), c = straight ? 0 : w - k, n = 6 * k;
        let x = du * shears[n] + dv * shears[n + 3], y = du * shears[n + 1] + dv * shears[n + 4], z = du * shears[n + 2] + dv * shears[n + 5];
        if (c > 0) {
            x += c * (du * shears[n + 6] + dv * shears[n + 9] - x);
            y += c * (du * shears[n + 7] + dv * shears[n + 10] - y);
            z += c * (du * shears[n + 8] + dv * shears[n + 11] - z);
        }
        return read(px + x, py + y, pz + z);
    };

    /** The content at lattice coordinates after the first `count` steps. @param du, dv  how far steps have moved it */
    const gather = (count, u, v, w, du, dv) => {
        while (count-- > 0) {
            const step = steps[count], across = step.axis === 1, lateral = (across ? u : v) - step.firstLateral;
            let e = across ? v : u;
            if (e > step.high && e <= step.high + rimSlack) e = step.high;
            if (e < step.low && e >= step.low - rimSlack) e = step.low;
            if (e < step.low || e > step.high || lateral < 0 || lateral > step.lastLateral) continue;
            const scale = step.fade === 0 ? 1 : step.scale(lateral, w);
            if (e < step.origin + scale * (step.start - step.origin) || e > step.lastBefore + scale * (step.last - step.lastBefore)) {
                if (step.inserts) continue;
                return background;
            }
            const {table, entries} = step, i = Math.floor(e), j = Math.floor(lateral), k = Math.floor(w), a = e - i, b = lateral - j, c = w - k;
            // The four columns of the cell, and the next entry in each; those of weight 0 may not exist.
            const up = a > 0 ? 1 : 0, aside = b > 0 ? entries * (j + 1 < step.laterals ? 1 : 1 - step.laterals) : 0;
            const behind = c > 0 ? entries * step.laterals * (k + 1 < step.slices ? 1 : 1 - step.slices) : 0;
            const n00 = entries * (j + step.laterals * k) + i - step.low, n10 = n00 + aside, n01 = n00 + behind, n11 = n01 + aside;
            let d = table[n00], whole = d === Math.floor(d);
            if (a + b + c > 0) {
                const d00 = d + (table[n00 + up] - d) * a, d10 = table[n10] + (table[n10 + up] - table[n10]) * a;
                const d01 = table[n01] + (table[n01 + up] - table[n01]) * a, d11 = table[n11] + (table[n11 + up] - table[n11]) * a;
                const low = d00 + (d10 - d00) * b, high = d01 + (d11 - d01) * b, mean = low + (high - low) * c;
                whole = whole && d00 === d && d10 === d && d01 === d && d11 === d;
                d = mean;
            }
            if (step.soft || whole) {
                const to = clamp(e + scale * d, step.origin, step.lastBefore);
                if (across) dv += to - e, v = to;
                else du += to - e, u = to;
                continue;
            }
            // Beside a seam values are blended, not positions.
            const goTo = to => {
                if (scale < 1) to = clamp(e + scale * (to - e), step.origin, step.lastBefore);
                return across ? gather(count, u, to, w, du, dv + to - e) : gather(count, to, v, w, du + to - e, dv);
            };
            // An inserted entry is the mean of its neighbours.
            const from = (entry, by) => Number.isInteger(by) ? goTo(entry + by) : 0.5 * (goTo(entry + by - 0.5) + goTo(entry + by + 0.5));
            const column = n => table[n] === table[n + up] ? from(e, table[n]) : (1 - a) * from(i, table[n]) + a * from(i + 1, table[n + up]);
            let sum = (1 - b) * (1 - c) * column(n00);
            if (b > 0) sum += b * (1 - c) * column(n10);
            if (c > 0) sum += (1 - b) * c * column(n01);
            if (b > 0 && c > 0) sum += b * c * column(n11);
            return sum;
        }
        return content(du, dv, w);
    };

    // Most volumes are carved by one step, and most of their cells move as one: this is quick, the rest is left to gather().
    const one = steps.length === 1 && steps[0].fade === 0 ? steps[0] : null;
    const {axis, low, high, start, last, origin, lastBefore, firstLateral, lastLateral, laterals, entries, slices, table, soft, inserts} = one ?? {};
    const sheet = entries * laterals;
    // In a box along the voxels all content moves along one line of voxels.
    const shift = one && straight && !lattice.around ? shears.slice(3 * axis, 3 * axis + 3) : [0, 0, 0];
    const lines = [0, 1, 2].filter(n => shift[n] !== 0), line = lines.length === 1 ? lines[0] : -1;
    const perVertex = shift[line], stride = [1, row, plane][line], lineEnd = size[line] - 1;
    const alongLine = (n, from, by) => {
        const to = from + by * perVertex, i = Math.floor(to + snapWidth), a = to - i;
        if (i < 0 || i >= lineEnd) return content(axis === 0 ? by : 0, axis === 0 ? 0 : by, 0);
        const at = n + stride * (i - from), low = volume[at];
        return a > snapWidth ? low + (volume[at + stride] - low) * a : low;
    };
    for (let z = box[0][2]; z <= box[1][2]; ++z)
        for (let y = box[0][1]; y <= box[1][1]; ++y)
            for (let x = box[0][0], n = x + row * y + plane * z; x <= box[1][0]; ++x, ++n) {
                const u = places[3 * n];
                if (u !== u) {
                    out[n] = volume[n];
                    continue;
                }
                const v = places[3 * n + 1], w = places[3 * n + 2];
                px = x, py = y, pz = z, pu = u, pv = v;
                if (one) {
                    const e = axis === 0 ? u : v, lateral = (axis === 0 ? v : u) - firstLateral;
                    if (e >= start && e <= last && e >= low && e <= high && lateral >= 0 && lateral <= lastLateral) {
                        const i = Math.floor(e), j = Math.floor(lateral), k = Math.floor(w), a = e - i, b = lateral - j, c = w - k;
                        let at = entries * j + sheet * k + i - low, d = table[at], known = soft || d === Math.floor(d);
                        if (a + b + c > 0) {
                            const up = a > 0 ? 1 : 0, aside = b > 0 ? entries * (j + 1 < laterals ? 1 : 1 - laterals) : 0;
                            const behind = c > 0 ? (k + 1 < slices ? sheet : -sheet * k) : 0;
                            const d00 = d + (table[at + up] - d) * a;
                            at += aside;
                            const d10 = table[at] + (table[at + up] - table[at]) * a;
                            at += behind;
                            const d11 = table[at] + (table[at + up] - table[at]) * a;
                            at -= aside;
                            const d01 = table[at] + (table[at + up] - table[at]) * a, near = d00 + (d10 - d00) * b;
                            known = soft || known && d00 === d && d10 === d && d01 === d && d11 === d;
                            d = near + (d01 + (d11 - d01) * b - near) * c;
                        }
                        if (known) {
                            const by = e + d < origin ? origin - e : e + d > lastBefore ? lastBefore - e : d;
                            if (by === 0) out[n] = volume[n];
                            else if (line >= 0) out[n] = alongLine(n, line === 0 ? x : line === 1 ? y : z, by) + 0.5;
                            else out[n] = (axis === 0 ? content(by, 0, w) : content(0, by, w)) + 0.5;
                            continue;
                        }
                    }
                }
                out[n] = gather(steps.length, u, v, w, 0, 0) + 0.5;
            }
}
