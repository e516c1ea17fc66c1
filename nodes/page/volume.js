'use strict';
// The lit volume, by WebGL2: rays through two textures of 8 bits, before and after, and one of overlays.

const vertexShader = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }`;

const fragmentShader = `#version 300 es
precision highp float;
precision highp sampler3D;
uniform sampler3D before, after, overlay;
uniform vec3 half_size, eye, right, up, forward, light;   // the box reaches from -half_size to half_size, and the eye is seen from its middle
uniform vec2 view_size, corner;                           // pixels: of the part of the canvas, and where it begins
uniform float zoom, wipe, thickness, steps;
uniform int tinted;
uniform vec3 ground, smoke;
out vec4 colour;
float density(vec3 p, bool carved) {
    vec3 at = p / half_size * 0.5 + 0.5;
    if (any(lessThan(at, vec3(0))) || any(greaterThan(at, vec3(1)))) return 0.0;
    return carved ? texture(after, at).r : texture(before, at).r;
}
void main() {
    vec2 pixel = gl_FragCoord.xy - corner, at = (2.0 * pixel - view_size) / min(view_size.x, view_size.y);
    bool carved = pixel.x > wipe * view_size.x;
    vec3 ray = normalize(forward * zoom + right * at.x + up * at.y);
    vec3 inverse = 1.0 / ray, a = (-half_size - eye) * inverse, b = (half_size - eye) * inverse;
    vec3 low = min(a, b), high = max(a, b);
    float near = max(max(max(low.x, low.y), low.z), 0.0), far = min(min(high.x, high.y), high.z);
    vec3 lit = vec3(0);
    float left = 1.0, stride = 2.0 * length(half_size) / steps;
    // Every other pixel begins half a step further, so that no rings are seen.
    float offset = fract(0.5 * (floor(gl_FragCoord.x) + floor(gl_FragCoord.y)));
    for (float t = near + stride * (0.25 + 0.5 * offset); t < far && left > 0.01; t += stride) {
        vec3 p = eye + t * ray;
        float here = density(p, carved);
        if (tinted != 0 && !carved) {
            vec4 tint = texture(overlay, p / half_size * 0.5 + 0.5);
            float cover = 1.0 - exp(-tint.a * 24.0 * stride);
            lit += left * cover * tint.rgb;
            left *= 1.0 - cover;
        }
        if (here < 0.004) continue;
        float shade = 0.0, reach = 0.04;
        for (int n = 0; n < 4; ++n) {
            shade += density(p + light * reach, carved) * 0.06;
            reach += 0.07;
        }
        float cover = 1.0 - exp(-here * thickness * stride);
        lit += left * cover * smoke * (0.25 + 0.85 * exp(-shade * thickness));
        left *= 1.0 - cover;
    }
    colour = vec4(lit + left * ground, 1);
}`;

class VolumeView {
    /** @param whole  around all scenes (wholeOf)
     * @throws Error if the browser has no WebGL2 */
    constructor(canvas, scenes, whole) {
        const longest = Math.max(...whole.lengths);
        this.canvas = canvas;
        this.boxes = scenes.map(scene => ({size: scene.size, halfSize: scene.size.map((n, axis) => n * scene.voxel[axis] / longest),
            middle: whole.offset(scene).map(x => 2 * x / longest)}));
        this.gl = canvas.getContext('webgl2', {antialias: false, preserveDrawingBuffer: true});
        if (!this.gl) throw new Error('no WebGL2');
        this.prepare();
    }
    /** Makes all that the context holds; again once a lost one is restored. */
    prepare() {
        const gl = this.gl, program = gl.createProgram();
        for (const [type, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
        gl.useProgram(program);
        this.place = name => gl.getUniformLocation(program, name);
        ['before', 'after', 'overlay'].forEach((name, unit) => gl.uniform1i(this.place(name), unit));
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.enable(gl.SCISSOR_TEST);
        for (const box of this.boxes)
            box.textures = [0, 1, 2].map(() => {
                const texture = gl.createTexture();
                gl.bindTexture(gl.TEXTURE_3D, texture);
                for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
                    [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_R, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_3D, key, value);
                return texture;
            });
        this.boxes.forEach((_, n) => this.setOverlay(n, null));
    }
    upload(n, unit, format, layout, bytes) {
        const gl = this.gl, {textures, size} = this.boxes[n];
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_3D, textures[unit]);
        gl.texImage3D(gl.TEXTURE_3D, 0, format, ...(bytes.length > 4 ? size : [1, 1, 1]), 0, layout, gl.UNSIGNED_BYTE, bytes);
    }
    /** @param n  number of the scene */
    setBefore(n, bytes) { this.upload(n, 0, this.gl.R8, this.gl.RED, bytes); }
    setAfter(n, bytes) { this.upload(n, 1, this.gl.R8, this.gl.RED, bytes); }
    /** @param bytes  red, green, blue and strength of each voxel; null: none */
    setOverlay(n, bytes) {
        this.boxes[n].tinted = bytes !== null;
        this.upload(n, 2, this.gl.RGBA8, this.gl.RGBA, bytes ?? new Uint8Array(4));
    }
    clear() {
        const gl = this.gl;
        gl.scissor(0, 0, this.canvas.width, this.canvas.height);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT);
    }
    /** Eye and directions of a camera that turns about the middle; z is up. */
    camera({yaw, pitch, zoom}) {
        const forward = [-Math.cos(yaw) * Math.cos(pitch), -Math.sin(yaw) * Math.cos(pitch), -Math.sin(pitch)];
        const right = [-Math.sin(yaw), Math.cos(yaw), 0], up = cross(right, forward);
        return {forward, right, up, eye: forward.map(x => -4 * x), zoom: 3.3 * zoom};
    }
    /** Draws a scene. @param area  left, low, width and height in the canvas, pixels */
    draw(n, area, turn, {wipe, brightness, ground, smoke}) {
        const gl = this.gl, camera = this.camera(turn), {halfSize, middle, size, textures, tinted} = this.boxes[n], [left, low, width, height] = area;
        if (gl.isContextLost()) return;
        gl.viewport(left, low, width, height);
        gl.scissor(left, low, width, height);
        textures.forEach((texture, unit) => {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_3D, texture);
        });
        gl.uniform3fv(this.place('half_size'), halfSize);
        gl.uniform3fv(this.place('eye'), minus(camera.eye, middle));
        for (const name of ['right', 'up', 'forward']) gl.uniform3fv(this.place(name), camera[name]);
        const light = [0, 1, 2].map(n => 0.5 * camera.up[n] - 0.45 * camera.right[n] - 0.4 * camera.forward[n]), length = Math.hypot(...light);
        gl.uniform3fv(this.place('light'), light.map(x => x / length));
        gl.uniform2f(this.place('view_size'), width, height);
        gl.uniform2f(this.place('corner'), left, low);
        gl.uniform1f(this.place('zoom'), camera.zoom);
        gl.uniform1f(this.place('wipe'), wipe);
        gl.uniform1f(this.place('thickness'), 14 * 2 ** brightness);
        gl.uniform1f(this.place('steps'), Math.min(160, 1.4 * Math.max(...size)));
        gl.uniform1i(this.place('tinted'), tinted ? 1 : 0);
        gl.uniform3fv(this.place('ground'), ground);
        gl.uniform3fv(this.place('smoke'), smoke);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    /** The pixel of a canvas of the same shape at which a place in voxels of a scene is seen. */
    project(n, at, turn, {width, height}) {
        const {forward, right, up, eye, zoom} = this.camera(turn), {size, halfSize, middle} = this.boxes[n];
        const from = at.map((x, n) => ((x + 0.5) / size[n] * 2 - 1) * halfSize[n] + middle[n] - eye[n]), depth = dot(from, forward);
        const scale = Math.min(width, height) / 2 * zoom / depth;
        return [width / 2 + scale * dot(from, right), height / 2 - scale * dot(from, up)];
    }
}
