// SPDX-License-Identifier: GPL-3.0-or-later
/// Small meshes and their pictures.

import { deflateSync } from "node:zlib";
import { colourOf } from "../../report/src/colour_scale.ts";
import type { Colour, ColourScale } from "../../report/src/colour_scale.ts";
import type { Mesh } from "../../report/src/data.ts";

export interface Shape {
    positions: number[];
    triangles: number[];
    /// NaN for vertices without a deviation.
    deviations: number[];
}

/// Numbers in [0, 1) that depend on the seed alone.
export function random(seed: number): () => number {
    let state = seed >>> 0;
    return () => {
        state = (state + 0x6d2b79f5) >>> 0;
        let mixed = Math.imul(state ^ (state >>> 15), state | 1);
        mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
        return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
    };
}

/// A torus with waves of this height, in the unit of the scan. The waves are its deviations.
export function torus(size: number, waves: number, seed: number, around = 56, across = 24): Shape {
    const next = random(seed);
    const [phase, tilt, frequency] = [next() * 6, next() * 6, 2 + Math.floor(next() * 4)];
    const shape: Shape = { positions: [], triangles: [], deviations: [] };
    for (let u = 0; u < around; ++u) {
        for (let v = 0; v < across; ++v) {
            const [a, b] = [(u / around) * 2 * Math.PI, (v / across) * 2 * Math.PI];
            const deviation = waves * (Math.sin(frequency * a + phase) * Math.cos(2 * b + tilt) + 0.4 * (next() - 0.5));
            const radius = 0.16 * size + deviation;
            const ring = 0.34 * size + radius * Math.cos(b);
            shape.positions.push(ring * Math.cos(a), ring * Math.sin(a), radius * Math.sin(b));
            shape.deviations.push(u === 3 ? Number.NaN : deviation);
            const at = (i: number, j: number) => (i % around) * across + (j % across);
            shape.triangles.push(at(u, v), at(u + 1, v), at(u, v + 1), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1));
        }
    }
    return shape;
}

export function encode(shape: Shape, hasDeviations: boolean): Mesh {
    const low = [0, 1, 2].map((axis) => axisOf(shape, axis).reduce((a, b) => Math.min(a, b))) as Mesh["low"];
    const high = [0, 1, 2].map((axis) => axisOf(shape, axis).reduce((a, b) => Math.max(a, b))) as Mesh["high"];
    const quantised = Uint16Array.from(shape.positions, (value, index) => Math.round((65535 * (value - low[index % 3]!)) / (high[index % 3]! - low[index % 3]! || 1)));
    const vertices = shape.positions.length / 3;
    const known = shape.deviations.filter((value) => !Number.isNaN(value));
    const [from, to] = [Math.min(...known), Math.max(...known)];
    const deviation = Uint16Array.from(shape.deviations, (value) => (Number.isNaN(value) ? 65535 : Math.round((65534 * (value - from)) / (to - from || 1))));
    return {
        low, high, vertices,
        positions: base64(quantised),
        triangles: base64(vertices > 65535 ? Uint32Array.from(shape.triangles) : Uint16Array.from(shape.triangles)),
        deviation: hasDeviations ? base64(deviation) : null,
        "deviation-low": hasDeviations ? from : 0,
        "deviation-high": hasDeviations ? to : 0,
    };
}

/// A picture of the shape from the front, as an address with the data of a PNG file. Without a scale the shape is grey.
export function picture(shape: Shape, scale: ColourScale | null, width = 240, height = 180, asPoints = false): string {
    const pixels = new Uint8Array(width * height * 3).fill(255);
    const depths = new Float64Array(width * height).fill(-Infinity);
    const back = unit([0.55, -1, 0.45]);
    const right = unit(cross([0, 0, 1], back));
    const up = cross(back, right);
    const reach = Math.max(...shape.positions.map(Math.abs)) * 1.12;
    const zoom = width / 2 / reach;
    const point = (index: number): Vec => {
        const position = shape.positions.slice(3 * index, 3 * index + 3) as Vec;
        return [width / 2 + zoom * dot(position, right), height / 2 - zoom * dot(position, up), dot(position, back)];
    };
    const points = Array.from({ length: shape.positions.length / 3 }, (_, index) => point(index));
    const plot = (x: number, y: number, depth: number, colour: Colour, light: number) => {
        const at = y * width + x;
        if (x < 0 || y < 0 || x >= width || y >= height || depth <= depths[at]!) return;
        depths[at] = depth;
        colour.forEach((value, channel) => (pixels[3 * at + channel] = Math.min(255, value * light)));
    };
    if (asPoints) for (const [x, y, depth] of points) plot(Math.round(x), Math.round(y), depth, [70, 90, 120], 1);
    for (let index = 0; index < (asPoints ? 0 : shape.triangles.length); index += 3) {
        const corners = shape.triangles.slice(index, index + 3);
        const [a, b, c] = corners.map((corner) => points[corner]!) as [Vec, Vec, Vec];
        const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if (area === 0) continue;
        const normal = unit(cross([b[0] - a[0], a[1] - b[1], (b[2] - a[2]) * zoom], [c[0] - a[0], a[1] - c[1], (c[2] - a[2]) * zoom]));
        const light = 0.42 + 0.6 * Math.abs(normal[2]);
        const deviation = corners.reduce((sum, corner) => sum + shape.deviations[corner]! / 3, 0);
        const colour: Colour = scale ? colourOf(scale, deviation) : [196, 200, 206];
        for (let y = Math.floor(Math.min(a[1], b[1], c[1])); y <= Math.max(a[1], b[1], c[1]); ++y) {
            for (let x = Math.floor(Math.min(a[0], b[0], c[0])); x <= Math.max(a[0], b[0], c[0]); ++x) {
                const s = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                const t = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                if (s >= -0.01 && t >= -0.01 && s + t <= 1.01) plot(x, y, a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]), colour, light);
            }
        }
    }
    return `data:image/png;base64,${png(pixels, width, height).toString("base64")}`;
}

type Vec = [number, number, number];
const dot = (a: Vec, b: Vec) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vec, b: Vec): Vec => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: Vec): Vec => a.map((value) => value / (Math.sqrt(dot(a, a)) || 1)) as Vec;

function axisOf(shape: Shape, axis: number): number[] {
    return shape.positions.filter((_, index) => index % 3 === axis);
}

function base64(values: Uint16Array | Uint32Array): string {
    return Buffer.from(values.buffer, values.byteOffset, values.byteLength).toString("base64");
}

function png(pixels: Uint8Array, width: number, height: number): Buffer {
    const rows = Buffer.alloc(height * (3 * width + 1));
    for (let y = 0; y < height; ++y) rows.set(pixels.subarray(3 * width * y, 3 * width * (y + 1)), y * (3 * width + 1) + 1);
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width, 0);
    header.writeUInt32BE(height, 4);
    header.set([8, 2, 0, 0, 0], 8);
    return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", header), chunk("IDAT", deflateSync(rows, { level: 9 })), chunk("IEND", Buffer.alloc(0))]);
}

function chunk(name: string, content: Buffer): Buffer {
    const named = Buffer.concat([Buffer.from(name, "latin1"), content]);
    const made = Buffer.alloc(named.length + 8);
    made.writeUInt32BE(content.length, 0);
    named.copy(made, 4);
    made.writeUInt32BE(crc(named), named.length + 4);
    return made;
}

function crc(bytes: Buffer): number {
    let value = 0xffffffff;
    for (const byte of bytes) {
        value ^= byte;
        for (let bit = 0; bit < 8; ++bit) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
    }
    return (value ^ 0xffffffff) >>> 0;
}
