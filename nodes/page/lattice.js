'use strict';
// The lattice's map (METHOD 2 and 3). Positions are voxels of the page. Lattice coordinates are vertices of the lattice as it was given, so
// what an anchored insertion adds lies below 0.

const snapWidth = 1e-5, rimSlack = 1e-4;  // as carve/lattice/snap.h
const rounded = x => x + 6755399441055744 - 6755399441055744;  // 1.5 * 2^52 leaves no bits for a fraction: quicker than Math.round
const snapped = x => { const whole = rounded(x); return Math.abs(x - whole) <= snapWidth ? whole : x; };
const clamp = (x, low, high) => x < low ? low : x > high ? high : x;
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const minus2 = (a, b) => [a[0] - b[0], a[1] - b[1]];
const along = (a, by, c) => [a[0] + c * by[0], a[1] + c * by[1], a[2] + c * by[2]];

/** A lattice in the page's voxels. */
class Lattice {
    /** @param before  number of planes before plane 0, which carves along w may reach
     * @param planes  per plane 12 numbers: position of vertex (0, 0), then the steps to the next vertex along u, v and w */
    constructor({shape, closed, around, box, before}, planes) {
        Object.assign(this, {shape, closed, around, box, before});
        this.planes = [];
        for (let n = 0; n < planes.length; n += 12) {
            const part = at => Array.from(planes.subarray(n + at, n + at + 3));
            this.planes.push({origin: part(0), u: part(3), v: part(6), w: part(9)});
        }
        this.hand = dot(cross(this.planes[0].u, this.planes[0].v), this.planes[0].w) < 0 ? -1 : 1;
        // `[plane][u, v][x, y, z]`; in a closed lattice the first plane follows the last.
        this.steps = Float64Array.from([...this.planes, this.planes[0]].flatMap(plane => [...plane.u, ...plane.v]));
        this.slabs = box ? 0 : this.planes.length - (closed ? 0 : 1);
    }
    plane(k) { return this.planes[k % this.planes.length]; }
    /** The step to the next vertex along an axis of a box. */
    stepAlong(axis) { return this.planes[0]['uvw'[axis]]; }
    /** The steps along a plane's directions to coordinates along u and v. Around a rig these are polar (METHOD 2). */
    across(u, v) {
        const angle = 2 * Math.PI / this.shape[1] * v;
        return this.around ? [u * Math.cos(angle), u * Math.sin(angle)] : [u, v];
    }
    /** Polar coordinates of steps along a plane's directions. */
    polar(x, y) {
        const turn = this.shape[1], u = snapped(Math.hypot(x, y)), v = snapped(turn / (2 * Math.PI) * Math.atan2(y, x)), positive = v < 0 ? v + turn : v;
        return [u, u > 0 && Math.fround(positive) < turn ? positive : 0];
    }
    /** World-to-page position of a vertex or of a point between two planes; straight on beyond the ends. */
    position(alongU, alongV, alongW) {
        const [u, v] = this.across(alongU, alongV), w = alongW + this.before;
        if (this.box || this.slabs < 1) return along(along(along(this.planes[0].origin, this.planes[0].u, u), this.planes[0].v, v), this.planes[0].w, w);
        const below = Math.floor(w), k = this.closed ? ((below % this.slabs) + this.slabs) % this.slabs : clamp(below, 0, this.slabs - 1);
        const a = this.plane(k), b = this.plane(k + 1), c = this.closed ? w - below : w - k;
        const mix = name => along(a[name], minus(b[name], a[name]), c);
        return along(along(mix('origin'), mix('u'), u), mix('v'), v);
    }
    /** The lattice coordinates of all voxels, three each; NaN outside.
     * @param first, last  the lowest and highest coordinates along u and v that count as inside */
    locate(size, first, last) {
        const out = new Float32Array(3 * size[0] * size[1] * size[2]).fill(NaN);
        if (this.box) this.locateInBox(size, first, last, out);
        else this.locateInSlabs(size, first, last, out);
        return out;
    }
    locateInBox(size, first, last, out) {
        const {origin, u, v, w} = this.planes[0];
        const volume = dot(u, cross(v, w)), gradients = [cross(v, w), cross(w, u), cross(u, v)].map(g => g.map(x => x / volume));
        const low = [first[0], first[1], -this.before], high = [last[0], last[1], this.planes.length - 1 - this.before];
        for (let z = 0, to = 0; z < size[2]; ++z)
            for (let y = 0; y < size[1]; ++y)
                for (let x = 0; x < size[0]; ++x, to += 3) {
                    const from = [x - origin[0], y - origin[1], z - origin[2]];
                    let inside = true;
                    for (let n = 0; n < 3; ++n) {
                        const at = dot(from, gradients[n]) - (n === 2 ? this.before : 0);
                        inside = inside && at >= low[n] - rimSlack && at <= high[n] + rimSlack;
                        out[to + n] = clamp(snapped(at), low[n], high[n]);
                    }
                    if (!inside) out.fill(NaN, to, to + 3);
                }
    }
    locateInSlabs(size, first, last, out) {
        const own = new Uint8Array(size[0] * size[1] * size[2]);  // 1: in cells beyond the lattice's own, 2: in its own
        // The steps along u and v that may lie inside.
        const [least, most] = this.around ? [[-last[0], -last[0]], [last[0], last[0]]] : [first, last];
        for (let k = 0; k < this.slabs; ++k) {
            const low = this.plane(k), high = this.plane(k + 1), o = low.origin, u = low.u, v = low.v;
            const chord = minus(high.origin, o), du = minus(high.u, u), dv = minus(high.v, v);
            const scaled = a => a.map(x => this.hand * x);
            // The normal U(c) x V(c), by powers of c.
            const normals = [scaled(cross(u, v)), scaled(cross(u, dv).map((x, n) => x + cross(du, v)[n])), scaled(cross(du, dv))];
            const from = !this.closed && k === 0 ? -rimSlack : 0, to = !this.closed && k + 1 === this.slabs ? 1 + rimSlack : 1;
            const normal = c => along(along(normals[0], normals[1], c), normals[2], c * c);
            const lowSide = [normal(from), along(o, chord, from)], highSide = [normal(to), along(o, chord, to)];
            const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
            for (const c of [from, to])
                for (const a of [least[0] - rimSlack, most[0] + rimSlack])
                    for (const b of [least[1] - rimSlack, most[1] + rimSlack]) {
                        const corner = along(along(along(o, chord, c), along(u, du, c), a), along(v, dv, c), b);
                        for (let n = 0; n < 3; ++n) {
                            box[0][n] = Math.min(box[0][n], corner[n]);
                            box[1][n] = Math.max(box[1][n], corner[n]);
                        }
                    }
            const begin = box[0].map(x => Math.max(0, Math.ceil(x - 1e-6))), end = box[1].map((x, n) => Math.min(size[n] - 1, Math.floor(x + 1e-6)));
            // Products with the place of a voxel rise evenly along x: with the normal's powers, the sides, and U and V by powers of c.
            const vectors = [...normals, lowSide[0], highSide[0], u, du, v, dv], ofChord = vectors.map(each => dot(each, chord));
            const ofSide = [dot(lowSide[0], minus(lowSide[1], o)), dot(highSide[0], minus(highSide[1], o))];
            const uu = [dot(u, u), 2 * dot(u, du), dot(du, du)], uv = [dot(u, v), dot(u, dv) + dot(v, du), dot(du, dv)];
            const vv = [dot(v, v), 2 * dot(v, dv), dot(dv, dv)], q = [0, 0, 0, 0], by = vectors.map(each => each[0]);
            const power = (of, c) => of[0] + c * (of[1] + c * of[2]);
            for (let z = begin[2]; z <= end[2]; ++z)
                for (let y = begin[1]; y <= end[1]; ++y) {
                    const from0 = vectors.map(each => dot(each, minus([0, y, z], o)));
                    for (let x = begin[0], voxel = x + size[0] * (y + size[1] * z); x <= end[0]; ++x, ++voxel) {
                        if (from0[3] + x * by[3] < ofSide[0] || from0[4] + x * by[4] >= ofSide[1] || own[voxel] === 2) continue;
                        q[0] = from0[0] + x * by[0];
                        q[1] = from0[1] + x * by[1] - ofChord[0];
                        q[2] = from0[2] + x * by[2] - ofChord[1];
                        q[3] = -ofChord[2];
                        const c = cubicRoot(q, from, to);
                        const ru = from0[5] + x * by[5] + c * (from0[6] + x * by[6] - ofChord[5] - c * ofChord[6]);
                        const rv = from0[7] + x * by[7] + c * (from0[8] + x * by[8] - ofChord[7] - c * ofChord[8]);
                        const pp = power(uu, c), pq = power(uv, c), qq = power(vv, c), scale = 1 / (pp * qq - pq * pq);
                        let a = (ru * qq - rv * pq) * scale, b = (rv * pp - ru * pq) * scale;
                        if (this.around) [a, b] = this.polar(a, b);
                        else if (!(b >= first[1] - rimSlack && b <= last[1] + rimSlack)) continue;
                        if (!(a >= first[0] - rimSlack && a <= last[0] + rimSlack)) continue;
                        const alongU = clamp(snapped(a), first[0], last[0]), alongV = this.around ? b : clamp(snapped(b), first[1], last[1]);
                        const inner = alongU >= 0 && alongU <= this.shape[0] - 1 && (this.around || alongV >= 0 && alongV <= this.shape[1] - 1);
                        if (!inner && own[voxel] === 1) continue;
                        own[voxel] = inner ? 2 : 1;
                        const w = Math.max(0, snapped(k + c));
                        out[3 * voxel] = alongU;
                        out[3 * voxel + 1] = alongV;
                        out[3 * voxel + 2] = w < this.slabs ? w - this.before : this.closed ? 0 : this.slabs - this.before;
                    }
                }
        }
    }
}

/** As cubic_root of carve/lattice/cubic_root.h. */
function cubicRoot(q, from, to) {
    let low = from - 1e-9, high = to + 1e-9, c = q[0] / -(q[1] + q[2] + q[3]);
    if (!(c >= low && c <= high)) c = (low + high) / 2;
    for (let n = 0; n < 100; ++n) {
        const value = ((q[3] * c + q[2]) * c + q[1]) * c + q[0], slope = (3 * q[3] * c + 2 * q[2]) * c + q[1];
        if (value >= 0) low = c;
        else high = c;
        const step = value / slope, next = c - step;
        if (!(next >= low && next <= high)) {
            c = (low + high) / 2;
            if (high - low <= 1e-13) break;
            continue;
        }
        c = next;
        if (Math.abs((3 * q[3] * c + q[2]) * step * step) <= 1e-13 * Math.abs(slope)) break;
    }
    return c;
}

/** The lowest and highest coordinates along u and v that any count of the last set reaches. */
function reachOf(lattice, sets) {
    const first = [0, 0], last = [lattice.shape[0] - 1, lattice.shape[1] - 1];
    for (const set of sets.filter(each => each.axis < 2)) {
        const grown = set.kind === 'insert' && !set.paired ? set.energies.length : 0;
        first[set.axis] -= Math.max(0, ...set.shifts.map(shift => -shift));
        last[set.axis] += grown;
    }
    return {first, last};
}

/** The cells of a lattice that fold (METHOD 2), each as its lower plane and its vertex (i, j). */
function foldedCells(lattice) {
    const out = [], [nu, nv] = lattice.shape;
    for (let k = 0; k < lattice.slabs; ++k) {
        const a = lattice.plane(k), b = lattice.plane(k + 1);
        const [up, down] = [a, b].map(plane => cross(plane.u, plane.v).map(x => lattice.hand * x));
        const bad = new Uint8Array(nu * nv);
        for (let j = 0, n = 0; j < nv; ++j)
            for (let i = 0; i < nu; ++i, ++n) {
                const [x, y] = lattice.across(i, j), low = along(along(a.origin, a.u, x), a.v, y), high = along(along(b.origin, b.u, x), b.v, y);
                bad[n] = dot(up, minus(high, a.origin)) > 0 && dot(down, minus(b.origin, low)) > 0 ? 0 : 1;
            }
        for (let j = 0; j < (lattice.around ? nv : Math.max(1, nv - 1)); ++j)
            for (let i = 0; i < Math.max(1, nu - 1); ++i) {
                const n = i + nu * j, right = i + 1 < nu ? 1 : 0, above = j + 1 < nv ? nu : lattice.around ? -nu * j : 0;
                if (bad[n] + bad[n + right] + bad[n + above] + bad[n + right + above] > 0) out.push({k: k - lattice.before, i, j});
            }
    }
    return out;
}
