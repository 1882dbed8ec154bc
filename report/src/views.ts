// SPDX-License-Identifier: GPL-3.0-or-later
/// Views in 3D of several meshes with linked cameras. One canvas below all of them draws them: browsers allow few WebGL
/// contexts, and copying pixels from a context is slow.

import {
    AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Mesh as Object3, MeshLambertMaterial,
    PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { colourOf, noData } from "./colour_scale.ts";
import type { Colour, ColourScale } from "./colour_scale.ts";
import { element } from "./element.ts";
import { decode } from "./mesh.ts";
import type { Mesh } from "./data.ts";

export interface ViewedMesh {
    title: string;
    mesh: Mesh;
    isCurrent: boolean;
}

export interface Views {
    readonly root: HTMLElement;
    dispose(): void;
}

interface View {
    frame: HTMLElement;
    scene: Scene;
    camera: PerspectiveCamera;
    controls: OrbitControls;
    geometry: BufferGeometry;
    material: MeshLambertMaterial;
}

const surface: Colour = [196, 200, 206];
const sentenceWithoutWebGL = "The views in 3D need WebGL 2, which this browser does not offer or has turned off. The pictures above show the same results.";
const turn = Math.PI / 24;
/// Pixels along an edge of the canvas. All devices with WebGL 2 can draw that many.
const largestCanvas = 4096;

export function views(meshes: ViewedMesh[], scale: ColourScale | null): Views {
    const canvas = element("canvas", { class: "views-canvas", "aria-hidden": "true" });
    // Asked here, because the renderer reports a missing context on the console.
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!context) return { root: element("p", null, sentenceWithoutWebGL), dispose: () => {} };
    const renderer = new WebGLRenderer({ canvas, context, antialias: true, alpha: true });
    renderer.setClearColor(0x000000, 0);
    renderer.setScissorTest(true);

    const box = boxOf(meshes);
    const all: View[] = [];
    let isLinking = false;
    let waiting = 0;
    for (const { mesh, title } of meshes) all.push(make(mesh, title));

    function make(mesh: Mesh, title: string): View {
        const frame = element("div", { class: "view", tabindex: 0, role: "img", "aria-label": `${title} in 3D. Arrow keys turn it, plus and minus zoom, 0 resets it.` });
        const { geometry, material } = drawable(mesh, scale);
        const scene = new Scene();
        const camera = new PerspectiveCamera(35, 1, box.radius / 100, box.radius * 100);
        camera.up.set(0, 0, 1);
        const light = new DirectionalLight(0xffffff, 0.6 * Math.PI);
        light.position.set(0.3, 0.5, 1);
        light.target.position.set(0, 0, -1);
        camera.add(light, light.target);
        scene.add(new Object3(geometry, material), new AmbientLight(0xffffff, 0.45 * Math.PI), camera);
        const controls = new OrbitControls(camera, frame);
        const view = { frame, scene, camera, controls, geometry, material };
        // The wheel scrolls the page until a view is chosen.
        controls.enableZoom = false;
        frame.addEventListener("focus", () => (controls.enableZoom = true));
        frame.addEventListener("blur", () => (controls.enableZoom = false));
        frame.addEventListener("pointerdown", () => frame.focus({ preventScroll: true }));
        frame.addEventListener("keydown", (event) => onKey(view, event));
        controls.addEventListener("change", () => link(view));
        reset(view);
        return view;
    }

    function reset(view: View): void {
        view.controls.target.copy(box.centre);
        view.camera.position.copy(box.centre).add(new Vector3(0.55, -1, 0.45).normalize().multiplyScalar(box.radius * 2.8));
        view.controls.update();
    }

    function onKey(view: View, event: KeyboardEvent): void {
        const offset = view.camera.position.clone().sub(view.controls.target);
        const side = new Vector3().crossVectors(view.camera.up, offset).normalize();
        const polar = offset.angleTo(view.camera.up);
        switch (event.key) {
            case "ArrowLeft": offset.applyAxisAngle(view.camera.up, -turn); break;
            case "ArrowRight": offset.applyAxisAngle(view.camera.up, turn); break;
            case "ArrowUp": offset.applyAxisAngle(side, -Math.min(turn, polar - 0.01)); break;
            case "ArrowDown": offset.applyAxisAngle(side, Math.min(turn, Math.PI - 0.01 - polar)); break;
            case "+": case "=": offset.multiplyScalar(0.85); break;
            case "-": offset.multiplyScalar(1 / 0.85); break;
            case "0": reset(view); event.preventDefault(); return;
            default: return;
        }
        event.preventDefault();
        view.camera.position.copy(view.controls.target).add(offset);
        view.controls.update();
    }

    /// Gives all cameras the position of one.
    function link(from: View): void {
        if (isLinking) return;
        isLinking = true;
        for (const view of all) {
            if (view === from) continue;
            view.camera.position.copy(from.camera.position);
            view.controls.target.copy(from.controls.target);
            view.controls.update();
        }
        isLinking = false;
        request();
    }

    function request(): void {
        if (waiting === 0) waiting = requestAnimationFrame(draw);
    }

    function draw(): void {
        waiting = 0;
        const place = stage.getBoundingClientRect();
        if (place.width === 0 || place.height === 0) return;
        renderer.setPixelRatio(Math.min(devicePixelRatio, 2, largestCanvas / place.width, largestCanvas / place.height));
        renderer.setSize(place.width, place.height);
        for (const view of all) {
            const box = view.frame.getBoundingClientRect();
            const [x, y] = [box.left - place.left + view.frame.clientLeft, place.bottom - box.bottom + view.frame.clientTop];
            const [width, height] = [view.frame.clientWidth, view.frame.clientHeight];
            renderer.setViewport(x, y, width, height);
            renderer.setScissor(x, y, width, height);
            view.camera.aspect = width / height;
            view.camera.updateProjectionMatrix();
            renderer.render(view.scene, view.camera);
            view.frame.dataset["camera"] = view.camera.position.toArray().map((value) => value.toPrecision(6)).join(" ");
        }
    }

    const list = element("ul", { class: "strip views" }, all.map((view, index) =>
        element("li", { class: meshes[index]!.isCurrent ? "current" : null }, element("figure", null, view.frame, element("figcaption", null, meshes[index]!.title)))));
    const stage = element("div", { class: "views-stage" }, canvas, list);
    const hint = element("p", { class: "quiet" }, "Drag or use the arrow keys to turn; all views turn together. Choose a view to zoom with the wheel.");
    const root = element("div", { class: "views-place" }, hint, stage);
    const sizes = new ResizeObserver(request);
    sizes.observe(stage);
    request();

    return {
        root,
        dispose() {
            cancelAnimationFrame(waiting);
            sizes.disconnect();
            for (const view of all) {
                view.controls.dispose();
                view.geometry.dispose();
                view.material.dispose();
            }
            renderer.dispose();
            context.getExtension("WEBGL_lose_context")?.loseContext();
        },
    };
}

function drawable(mesh: Mesh, scale: ColourScale | null): { geometry: BufferGeometry; material: MeshLambertMaterial } {
    const { positions, triangles, deviations } = decode(mesh);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setIndex(new BufferAttribute(triangles, 1));
    geometry.computeVertexNormals();
    if (deviations && scale) geometry.setAttribute("color", new BufferAttribute(colours(deviations, scale), 3));
    const isColoured = deviations !== null && scale !== null;
    const material = new MeshLambertMaterial({ vertexColors: isColoured, side: DoubleSide });
    if (!isColoured) material.color.copy(linear(surface));
    return { geometry, material };
}

function colours(deviations: Float32Array, scale: ColourScale): Float32Array {
    const result = new Float32Array(3 * deviations.length);
    deviations.forEach((deviation, index) => linear(Number.isNaN(deviation) ? noData : colourOf(scale, deviation)).toArray(result, 3 * index));
    return result;
}

/// The renderer calculates with linear colours.
function linear(colour: Colour): Color {
    return new Color().setRGB(colour[0] / 255, colour[1] / 255, colour[2] / 255, "srgb");
}

function boxOf(meshes: ViewedMesh[]): { centre: Vector3; radius: number } {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = new Vector3(-Infinity, -Infinity, -Infinity);
    for (const { mesh } of meshes) {
        low.min(new Vector3(...mesh.low));
        high.max(new Vector3(...mesh.high));
    }
    return { centre: low.clone().add(high).multiplyScalar(0.5), radius: Math.max(low.distanceTo(high) / 2, 1e-9) };
}
