// SPDX-License-Identifier: GPL-3.0-or-later
/// Decodes meshes.

import type { Mesh } from "./data.ts";

export interface DecodedMesh {
    /// 3 per vertex, in the unit of the scan.
    positions: Float32Array;
    /// 3 per triangle.
    triangles: Uint16Array | Uint32Array;
    /// One per vertex, NaN without a deviation; null if no vertex has one.
    deviations: Float32Array | null;
}

const largest = 65535;

export function decode(mesh: Mesh): DecodedMesh {
    const quantised = new Uint16Array(bytesOf(mesh.positions));
    const positions = new Float32Array(3 * mesh.vertices);
    for (let index = 0; index < positions.length; ++index) {
        const axis = index % 3;
        const low = mesh.low[axis]!;
        positions[index] = low + ((quantised[index] ?? 0) / largest) * (mesh.high[axis]! - low);
    }
    const buffer = bytesOf(mesh.triangles);
    const triangles = mesh.vertices > largest ? new Uint32Array(buffer) : new Uint16Array(buffer);
    return { positions, triangles, deviations: mesh.deviation === null ? null : deviationsOf(mesh, mesh.deviation) };
}

function deviationsOf(mesh: Mesh, text: string): Float32Array {
    const [low, high] = [mesh["deviation-low"], mesh["deviation-high"]];
    return Float32Array.from(new Uint16Array(bytesOf(text)), (value) =>
        value === largest ? Number.NaN : low + (value / (largest - 1)) * (high - low));
}

function bytesOf(base64: string): ArrayBuffer {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let index = 0; index < text.length; ++index) bytes[index] = text.charCodeAt(index);
    return bytes.buffer;
}
