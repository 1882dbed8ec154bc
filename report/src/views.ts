// SPDX-License-Identifier: GPL-3.0-or-later
/// Views in 3D of several meshes with linked cameras. One WebGL context draws all of them: browsers allow few.

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
    canvas: HTMLCanvasElement;
    scene: Scene;
    camera: PerspectiveCamera;
    controls: OrbitControls;
    geometry: BufferGeometry;
    material: MeshLambertMaterial;
}

const surface: Colour = [196, 200, 206];
const sentenceWithoutWebGL = "The views in 3D need WebGL 2, which this browser does not offer or has turned off. The pictures above show the same results.";
const turn = Math.PI / 24;

export function views(meshes: ViewedMesh[], scale: ColourScale | null): Views {
    const screen = document.createElement("canvas");
    // Asked here, because the renderer reports a missing context on the console.
    const context = screen.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    if (!context) return { root: element("p", null, sentenceWithoutWebGL), dispose: () => {} };
    const renderer = new WebGLRenderer({ canvas: screen, context, antialias: true, alpha: true });
    renderer.setClearColor(0x000000, 0);

    const box = boxOf(meshes);
    const all = meshes.map(({ mesh, title }) => make(mesh, title));
    let isLinking = false;
    let frame = 0;

    function make(mesh: Mesh, title: string): View {
        const canvas = element("canvas", { class: "view", tabindex: 0, role: "img", "aria-label": `${title} in 3D. Arrow keys turn it, plus and minus zoom, 0 resets it.` });
        const { geometry, material } = drawable(mesh, scale);
        const scene = new Scene();
        const camera = new PerspectiveCamera(35, 1, box.radius / 100, box.radius * 100);
        camera.up.set(0, 0, 1);
        const light = new DirectionalLight(0xffffff, 0.6 * Math.PI);
        light.position.set(0.3, 0.5, 1);
        light.target.position.set(0, 0, -1);
        camera.add(light, light.target);
        scene.add(new Object3(geometry, material), new AmbientLight(0xffffff, 0.45 * Math.PI), camera);
        const controls = new OrbitControls(camera, canvas);
        const view = { canvas, scene, camera, controls, geometry, material };
        // The wheel scrolls the page until a view is chosen.
        controls.enableZoom = false;
        canvas.addEventListener("focus", () => (controls.enableZoom = true));
        canvas.addEventListener("blur", () => (controls.enableZoom = false));
        canvas.addEventListener("pointerdown", () => canvas.focus({ preventScroll: true }));
        canvas.addEventListener("keydown", (event) => onKey(view, event));
        controls.addEventListener("change", () => link(view));
        reset(view);
        return view;
    }

    function reset(view: View): void {
        view.controls.target.copy(box.centre);
        view.camera.position.copy(box.centre).add(new Vector3(0.55, -1, 0.45).normalize().multiplyScalar(box.radius * 3.4));
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
        if (frame === 0) frame = requestAnimationFrame(draw);
    }

    function draw(): void {
        frame = 0;
        const ratio = Math.min(devicePixelRatio, 2);
        for (const view of all) {
            const [width, height] = [view.canvas.clientWidth * ratio, view.canvas.clientHeight * ratio].map(Math.round) as [number, number];
            if (width === 0 || height === 0) continue;
            if (screen.width !== width || screen.height !== height) renderer.setSize(width, height, false);
            if (view.canvas.width !== width || view.canvas.height !== height) [view.canvas.width, view.canvas.height] = [width, height];
            view.camera.aspect = width / height;
            view.camera.updateProjectionMatrix();
            renderer.render(view.scene, view.camera);
            const plane = view.canvas.getContext("2d");
            plane?.clearRect(0, 0, width, height);
            plane?.drawImage(screen, 0, 0);
            view.canvas.dataset["camera"] = view.camera.position.toArray().map((value) => value.toPrecision(6)).join(" ");
            view.canvas.dataset["drawn"] = "true";
        }
    }

    const root = element("ul", { class: "strip views" }, all.map((view, index) =>
        element("li", { class: meshes[index]!.isCurrent ? "current" : null }, element("figure", null, view.canvas, element("figcaption", null, meshes[index]!.title)))));
    const sizes = new ResizeObserver(request);
    for (const view of all) sizes.observe(view.canvas);
    request();

    return {
        root,
        dispose() {
            cancelAnimationFrame(frame);
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
