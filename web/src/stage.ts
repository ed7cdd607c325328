// What is drawn, by three.js: the surfaces, one mesh for each kind of part over the same vertices, and the marks.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  CustomBlending,
  DoubleSide,
  Float32BufferAttribute,
  GLSL3,
  HalfFloatType,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  OneFactor,
  PerspectiveCamera,
  PlaneGeometry,
  Points,
  Scene as Graph,
  ShaderMaterial,
  Sphere,
  Vector3,
  Vector4,
  WebGLRenderTarget,
  WebGLRenderer,
  type IUniform,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Plane } from './cut';
import type { Geometry } from './geometry';
import { kKinds, type Kind, type Scene, type Vec3 } from './scene';
import {
  kCapFragment,
  kCapVertex,
  kCountFragment,
  kCountVertex,
  kSurfaceFragment,
  kSurfaceVertex,
} from './shaders';

export type Outer = 'solid' | 'faded' | 'off';

export interface Shown {
  readonly outer: Outer;
  readonly kinds: ReadonlySet<Kind>; // besides the outer surface
  readonly marks: boolean;
  readonly cutAlone: boolean;
  readonly planes: readonly Plane[]; // at most two
}

export interface Theme {
  readonly cut: Vec3; // 0 to 1
  readonly hatch: Vec3;
  readonly other: Vec3; // of modifiers and planned spheres
  readonly chosen: Vec3;
  readonly mark: Vec3;
}

// Where the camera is and what it looks at, mm in the model's coordinates.
export interface View {
  readonly from: Vec3;
  readonly at: Vec3;
}

// Planes that take nothing away.
const kNowhere = new Vector4(0, 0, 1, 1e9);

const kMarkVertex = /* glsl */ `
uniform float size;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;
const kMarkFragment = /* glsl */ `
precision highp float;
uniform vec3 ink;
out vec4 colour;
void main() {
  float off = 2.0 * length(gl_PointCoord - 0.5);
  if (off > 1.0) discard;
  colour = off > 0.78 || off < 0.3 ? vec4(1.0) : vec4(ink, 1.0);
}`;

type Uniforms = Record<string, IUniform>;

// Edges are smoothed unless that would make large models slow, which are drawn by the CPU.
function isSmoothQuick(geometry: Geometry): boolean {
  const kFew = 3 * 250_000;
  if (geometry.triangles.length < kFew) return true;
  const context = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!context) return false;
  const names = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return !/swiftshader|llvmpipe|software|basic render/i.test(name);
}

const isOutside = (kind: Kind): boolean => kind === 'outer' || kind === 'remnant';

export class Stage {
  readonly camera = new PerspectiveCamera(30, 1, 1, 1000);
  readonly controls: OrbitControls;
  // Where the model is seen whole from; null as soon as who looks has moved.
  private fitted: Vec3 | null = null;
  private readonly renderer: WebGLRenderer;
  private readonly graph = new Graph();
  private readonly counted = new Graph();
  private readonly counts = new WebGLRenderTarget(1, 1, { type: HalfFloatType, depthBuffer: false });
  private readonly tint: BufferAttribute;
  // What all materials share.
  private readonly planes: IUniform<Vector4[]> = { value: [kNowhere.clone(), kNowhere.clone()] };
  private readonly chosenColour: IUniform<Vector3> = { value: new Vector3() };
  private readonly cap: Uniforms;
  private readonly solids = new Map<Kind, Mesh>();
  private readonly counters = new Map<Kind, Mesh>();
  private readonly glass: Mesh[] = [];
  private readonly caps: Mesh[] = [];
  private readonly marks: (Points | LineSegments)[] = [];
  private readonly radius: number;
  // Some old devices cannot count.
  readonly closesCuts: boolean;
  private isDisposed = false;
  private isHeld = false; // by a pointer
  private wanted = false;
  private cuts: readonly Plane[] = [];
  private isCapped = false;
  onDrawn: (() => void) | null = null;
  onMoved: (() => void) | null = null; // by who looks
  private readonly sizes: ResizeObserver;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly scene: Scene,
    private readonly geometry: Geometry,
    normals: Int8Array,
    tints: Uint8Array,
  ) {
    const smooth = isSmoothQuick(geometry);
    this.counts.samples = smooth ? 4 : 0;
    this.renderer = new WebGLRenderer({ canvas, antialias: smooth, alpha: true, preserveDrawingBuffer: true });
    const counts = ['EXT_color_buffer_float', 'EXT_color_buffer_half_float'].some((name) => this.renderer.extensions.has(name));
    this.closesCuts = scene.closed && counts;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.radius = Math.max(Math.hypot(...geometry.size) / 2, 1e-3);
    this.camera.up.set(...scene.up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.minDistance = this.radius * 0.05;
    this.controls.maxDistance = this.radius * 20;
    this.controls.addEventListener('change', () => {
      if (this.isHeld) this.onMoved?.();
      this.draw();
    });
    this.controls.addEventListener('start', () => {
      this.fitted = null;
      this.isHeld = true;
    });
    this.controls.addEventListener('end', () => {
      this.isHeld = false;
    });
    this.tint = new BufferAttribute(tints, 4, true);
    this.cap = {
      planes: this.planes,
      counts: { value: this.counts.texture },
      hatch: { value: this.radius / 30 },
      opacity: { value: 1 },
      cutColour: { value: new Vector3() },
      hatchColour: { value: new Vector3() },
      otherColour: { value: new Vector3() },
    };
    this.addSurfaces(normals);
    this.addCaps();
    this.addMarks();
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  private addSurfaces(normals: Int8Array): void {
    const position = new BufferAttribute(this.geometry.positions, 3);
    const slope = new BufferAttribute(normals, 4, true);
    const index = new BufferAttribute(this.geometry.triangles, 1);
    for (const kind of kKinds) {
      const parts = this.geometry.parts.filter((part) => part.kind === kind);
      if (parts.length === 0) continue;
      const last = parts[parts.length - 1];
      const shape = new BufferGeometry();
      shape.setAttribute('position', position);
      shape.setAttribute('slope', slope);
      shape.setAttribute('tint', this.tint);
      shape.setIndex(index);
      shape.boundingSphere = new Sphere(new Vector3(), this.radius);
      shape.setDrawRange(3 * parts[0].firstTriangle, 3 * (last.firstTriangle + last.triangles - parts[0].firstTriangle));
      this.solids.set(kind, this.add(this.graph, shape, this.surface(false), 0));
      if (isOutside(kind)) this.glass.push(this.add(this.graph, shape, this.surface(true), 2));
      this.counters.set(kind, this.add(this.counted, shape, this.counter(kind === 'void' && this.fillsVoids()), 0));
    }
  }

  private fillsVoids(): boolean {
    return this.scene.use === 'modifiers' || this.scene.use === 'packed';
  }

  private surface(isGlass: boolean): ShaderMaterial {
    return new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kSurfaceVertex,
      fragmentShader: kSurfaceFragment,
      side: DoubleSide,
      forceSinglePass: true,
      transparent: isGlass,
      depthWrite: !isGlass,
      uniforms: { planes: this.planes, isGlass: { value: isGlass }, chosenColour: this.chosenColour },
    });
  }

  private counter(fillsVoids: boolean): ShaderMaterial {
    return new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kCountVertex,
      fragmentShader: kCountFragment,
      side: DoubleSide,
      forceSinglePass: true,
      transparent: true,
      depthTest: false,
      depthWrite: false,
      blending: CustomBlending,
      blendSrc: OneFactor,
      blendDst: OneFactor,
      blendSrcAlpha: OneFactor,
      blendDstAlpha: OneFactor,
      uniforms: { planes: this.planes, fillsVoids: { value: fillsVoids } },
    });
  }

  private add(graph: Graph, shape: BufferGeometry, material: ShaderMaterial, order: number): Mesh {
    const mesh = new Mesh(shape, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    graph.add(mesh);
    return mesh;
  }

  private addCaps(): void {
    const shape = new PlaneGeometry(2.1 * this.radius, 2.1 * this.radius);
    for (const plane of [0, 1]) {
      const material = new ShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: kCapVertex,
        fragmentShader: kCapFragment,
        side: DoubleSide,
        transparent: true,
        uniforms: { ...this.cap, plane: { value: plane } },
      });
      this.caps.push(this.add(this.graph, shape, material, 1));
    }
  }

  private offCentre([x, y, z]: Vec3): Vec3 {
    const { centre } = this.geometry;
    return [x - centre[0], y - centre[1], z - centre[2]];
  }

  private fromCentre(values: readonly number[]): number[] {
    return values.map((value, i) => value - this.geometry.centre[i % 3]);
  }

  private addMarks(): void {
    const { marks } = this.scene;
    if (marks.length === 0) return;
    const points = new BufferGeometry();
    points.setAttribute('position', new Float32BufferAttribute(this.fromCentre(marks.flatMap((mark) => [...mark.place])), 3));
    const dots = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kMarkVertex,
      fragmentShader: kMarkFragment,
      depthTest: false,
      transparent: true,
      uniforms: { size: { value: 13 * this.renderer.getPixelRatio() }, ink: { value: new Vector3() } },
    });
    const lines = new BufferGeometry();
    lines.setAttribute('position', new Float32BufferAttribute(this.fromCentre(marks.flatMap((mark) => [...mark.lines])), 3));
    this.marks.push(new LineSegments(lines, new LineBasicMaterial({ depthTest: false, transparent: true })));
    this.marks.push(new Points(points, dots));
    for (const mark of this.marks) {
      mark.frustumCulled = false;
      mark.renderOrder = 3;
      this.graph.add(mark);
    }
  }

  paint(theme: Theme): void {
    this.cap.cutColour.value.set(...theme.cut);
    this.cap.hatchColour.value.set(...theme.hatch);
    this.cap.otherColour.value.set(...theme.other);
    this.chosenColour.value.set(...theme.chosen);
    for (const mark of this.marks) {
      if (mark instanceof Points) (mark.material as ShaderMaterial).uniforms.ink.value.set(...theme.mark);
      else (mark.material as LineBasicMaterial).color.setRGB(...theme.mark);
    }
    this.draw();
  }

  // After `tints` have changed.
  tinted(): void {
    this.tint.needsUpdate = true;
    this.draw();
  }

  show({ outer, kinds, marks, cutAlone, planes }: Shown): void {
    // Voids that are not shown are not made, unless holes lead into them.
    const areVoidsMade = kinds.has('void') || this.solids.has('hole');
    for (const [kind, mesh] of this.solids)
      mesh.visible = !cutAlone && (isOutside(kind) ? outer === 'solid' : kinds.has(kind));
    for (const [kind, mesh] of this.counters)
      mesh.visible = isOutside(kind) || (this.fillsVoids() ? kinds.has(kind) : areVoidsMade);
    for (const mesh of this.glass) mesh.visible = outer === 'faded' && !cutAlone;
    for (const mark of this.marks) mark.visible = marks;
    this.isCapped = this.closesCuts && (outer !== 'off' || cutAlone);
    this.cap.opacity.value = outer === 'solid' || cutAlone ? 1 : 0.4;
    this.cuts = planes;
    this.caps.forEach((cap, i) => {
      const plane = planes[i];
      const at = this.planes.value[i];
      if (!plane) return at.copy(kNowhere);
      at.set(...plane.normal, plane.offset);
      const normal = new Vector3(...plane.normal);
      cap.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
      return cap.position.copy(normal.multiplyScalar(plane.offset));
    });
    this.draw();
  }

  // From where `way` points to what is left of the model, as near as all of that is seen.
  lookFrom(way: Vec3): void {
    this.fitted = way;
    const left = this.verticesLeft();
    const { target } = this.controls;
    target.copy(new Box3().setFromPoints([...left]).getCenter(new Vector3()));
    const off = new Vector3(...way).setLength(this.radius);
    this.camera.position.copy(target).add(off);
    this.controls.update();
    this.camera.position.copy(target).add(off.setLength(this.distanceToSee(left)));
    this.controls.update();
    this.draw();
  }

  // Some of what is not cut away, all over it; what is, moved onto the plane, stands for the cut face.
  private verticesLeft(): readonly Vector3[] {
    const kMost = 40_000;
    const { positions } = this.geometry;
    const stride = 3 * Math.max(1, Math.ceil(positions.length / 3 / kMost));
    const left: Vector3[] = [];
    for (let i = 0; i < positions.length; i += stride) {
      const at = new Vector3().fromArray(positions, i);
      for (const { normal, offset } of this.cuts) {
        const across = new Vector3(...normal);
        at.addScaledVector(across, -Math.max(at.dot(across) - offset, 0));
      }
      left.push(at);
    }
    return left.length > 0 ? left : [new Vector3()];
  }

  // In the direction in which the camera is.
  private distanceToSee(places: readonly Vector3[]): number {
    const kMargin = 1.06;
    this.camera.updateMatrixWorld();
    const [right, up, back] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, back);
    const high = Math.tan((this.camera.fov * Math.PI) / 360) / kMargin;
    const wide = high * this.camera.aspect;
    const at = new Vector3();
    let distance = this.radius * 0.1;
    for (const place of places) {
      at.copy(place).sub(this.controls.target);
      const aside = Math.max(Math.abs(at.dot(right)) / wide, Math.abs(at.dot(up)) / high);
      distance = Math.max(distance, at.dot(back) + aside);
    }
    return distance;
  }

  lookAt(place: Vec3): void {
    this.fitted = null;
    const target = new Vector3(...this.offCentre(place));
    this.camera.position.add(target).sub(this.controls.target);
    this.controls.target.copy(target);
    this.movedByHand();
  }

  view(): View {
    const inModel = (at: Vector3): Vec3 => {
      const [x, y, z] = this.geometry.centre;
      return [at.x + x, at.y + y, at.z + z];
    };
    return { from: inModel(this.camera.position), at: inModel(this.controls.target) };
  }

  lookAs({ from, at }: View): void {
    this.fitted = null;
    this.controls.target.set(...this.offCentre(at));
    this.camera.position.set(...this.offCentre(from));
    this.controls.update();
    this.draw();
  }

  private movedByHand(): void {
    this.controls.update();
    this.draw();
    this.onMoved?.();
  }

  // Radians about the axis that is up, and up or down.
  turn(aside: number, up: number): void {
    this.fitted = null;
    const off = this.camera.position.clone().sub(this.controls.target);
    const axis = this.camera.up;
    const side = new Vector3().crossVectors(axis, off).normalize();
    const polar = off.angleTo(axis);
    const turned = Math.min(Math.max(polar - up, 0.02), Math.PI - 0.02);
    off.applyAxisAngle(side, turned - polar).applyAxisAngle(axis, aside);
    this.camera.position.copy(this.controls.target).add(off);
    this.movedByHand();
  }

  zoom(factor: number): void {
    this.fitted = null;
    const off = this.camera.position.clone().sub(this.controls.target);
    const length = Math.min(Math.max(off.length() / factor, this.controls.minDistance), this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(off.setLength(length));
    this.movedByHand();
  }

  // Whether the camera is on the side that is taken away.
  faces({ normal, offset }: Plane): boolean {
    return this.camera.position.dot(new Vector3(...normal)) > offset;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement ?? this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.counts.setSize(this.canvas.width, this.canvas.height);
    this.camera.aspect = width / height;
    if (this.fitted) this.lookFrom(this.fitted);
    this.draw();
  }

  // With the next frame of the browser, once however often it is asked for.
  draw(): void {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => {
      this.wanted = false;
      this.drawNow();
    });
  }

  drawNow(): void {
    if (this.isDisposed) return;
    const distance = this.camera.position.length();
    this.camera.near = Math.max(distance - this.radius * 1.5, this.radius * 0.01);
    this.camera.far = distance + this.radius * 1.5;
    this.camera.updateProjectionMatrix();
    // A cut face is seen from the side that is taken away.
    let faces = 0;
    this.caps.forEach((cap, i) => {
      const plane = this.cuts[i];
      cap.visible = this.isCapped && !!plane && this.faces(plane);
      if (cap.visible) ++faces;
    });
    if (faces > 0) {
      this.renderer.setRenderTarget(this.counts);
      this.renderer.render(this.counted, this.camera);
      this.renderer.setRenderTarget(null);
    }
    this.renderer.render(this.graph, this.camera);
    this.onDrawn?.();
  }

  // Where a place of the model is on the canvas, in CSS pixels.
  project(place: Vec3): readonly [number, number] {
    this.camera.updateMatrixWorld();
    const at = new Vector3(...this.offCentre(place)).project(this.camera);
    return [((at.x + 1) / 2) * this.canvas.clientWidth, ((1 - at.y) / 2) * this.canvas.clientHeight];
  }

  // The ray through a point of the canvas, from the geometry's centre.
  ray(x: number, y: number): { readonly from: Vec3; readonly way: Vec3 } {
    this.camera.updateMatrixWorld();
    const at = new Vector3((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight, 0.5);
    const way = at.unproject(this.camera).sub(this.camera.position).normalize();
    return { from: this.camera.position.toArray(), way: way.toArray() };
  }

  // Gives back the memory of the device; nothing can be drawn afterwards.
  dispose(): void {
    this.sizes.disconnect();
    this.controls.dispose();
    this.onDrawn = null;
    this.isDisposed = true;
    this.counts.dispose();
    const context = this.renderer.getContext();
    this.renderer.dispose();
    context.getExtension('WEBGL_lose_context')?.loseContext();
  }
}
