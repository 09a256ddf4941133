// Bodies: URDF documents (urdf-loader) and marker shapes as instanced meshes, one draw call for all that look alike.
import * as THREE from "three";
import { ColladaLoader } from "three/examples/jsm/loaders/ColladaLoader.js";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import URDFLoader from "urdf-loader";
import { BODY_COLORS } from "./colors.js";
import { inflate } from "./unpack.js";

const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);
const PRIMITIVES = {
  BoxGeometry: new THREE.BoxGeometry(1, 1, 1),
  SphereGeometry: new THREE.SphereGeometry(1, 24, 16),
  CylinderGeometry: new THREE.CylinderGeometry(1, 1, 1, 32),
};

// THREE.Object3D of an embedded mesh; its name is NUMBER.KIND.
const PARSERS = {
  stl: (bytes, material) => new THREE.Mesh(new STLLoader().parse(bytes.buffer), material),
  dae: (bytes) => new ColladaLoader(withoutTextures()).parse(new TextDecoder().decode(bytes), "").scene,
  obj: (bytes, material) => {
    const group = new OBJLoader().parse(new TextDecoder().decode(bytes));
    group.traverse((child) => child.isMesh && (child.material = material));
    return group;
  },
};

// Files that a mesh names are not in the page: every picture is one white pixel.
function withoutTextures() {
  const manager = new THREE.LoadingManager();
  manager.setURLModifier(() => "data:image/gif;base64,R0lGODlhAQABAIAAAP///wAAACwAAAAAAQABAAACAkQBADs=");
  return manager;
}

export class Bodies {
  constructor(data, tracks, note) {
    Object.assign(this, { data, tracks, note });
    this.group = new THREE.Group();
    this.matrices = Array.from({ length: tracks.count }, () => new THREE.Matrix4());
    this.known = new Uint8Array(tracks.count);
    this.items = []; // {geometry, material, color, opacity, track, local}
    // What the camera can follow: bodies by their first drawn link, shapes of markers.
    this.things = data.bodies.filter(({ links }) => links.length).map(({ name, links }) => ({ name, track: links[0].track }))
      .concat(data.shapes.map(({ track }, number) => ({ name: `shape ${number}`, track })));
    this.boxes = []; // of each track: around what is drawn, in its own frame
  }

  async load() {
    this.meshes = await Promise.all(this.data.meshes.map((mesh) => inflate(mesh.data)));
    this.parsed = new Map();
    const loader = new URDFLoader(withoutTextures());
    loader.loadMeshCb = (path, manager, material, done) => done(this.mesh(path, material));
    const robots = this.data.documents.map((text) => this.looks(loader.parse(text)));
    this.data.bodies.forEach((body, number) => {
      for (const link of body.links)
        for (const look of robots[body.document].get(link.number) ?? []) this.add(look, link.track, number);
    });
    this.data.shapes.forEach((shape) => this.addShape(shape));
    this.batch();
  }

  // A copy of an embedded mesh, parsed once: copies share their geometry. Nothing where it cannot be read.
  mesh(name, material) {
    if (!this.parsed.has(name)) {
      const [number, kind] = name.split(".");
      try {
        this.parsed.set(name, PARSERS[kind](this.meshes[number], material));
      } catch (error) {
        this.note(`mesh ${name}: ${error.message}`);
        this.parsed.set(name, null);
      }
    }
    const copy = this.parsed.get(name)?.clone() ?? new THREE.Group();
    if (!name.endsWith(".dae")) copy.traverse((child) => child.isMesh && (child.material = material));
    return copy;
  }

  // Map of a link's number to the meshes drawn for it, in its frame.
  looks(robot) {
    robot.updateMatrixWorld(true); // every joint is the identity: world is the link
    const found = new Map();
    const visit = (object, number, hasColor) => {
      if (object.isURDFLink && /^l\d+$/.test(object.urdfName)) number = Number(object.urdfName.slice(1));
      if (object.isURDFVisual) hasColor = [...object.urdfNode.children].some((child) => child.nodeName === "material");
      if (object.isMesh) {
        const list = found.get(number) ?? [];
        list.push({ geometry: PRIMITIVES[object.geometry.type] ?? object.geometry, material: object.material, hasColor, local: object.matrixWorld.clone() });
        found.set(number, list);
      }
      object.children.forEach((child) => visit(child, number, hasColor));
    };
    visit(robot, 0, false);
    return found;
  }

  add(look, track, body) {
    const material = Array.isArray(look.material) ? look.material[0] : look.material;
    const own = look.hasColor || material.name || !material.color.equals(new THREE.Color(1, 1, 1));
    const color = own ? material.color : new THREE.Color(BODY_COLORS[body % BODY_COLORS.length]);
    this.push({ geometry: look.geometry, color, opacity: material.opacity, track, local: look.local });
  }

  addShape(shape) {
    const [r, g, b, a] = shape.color, color = new THREE.Color(r, g, b);
    const scale = new THREE.Matrix4().makeScale(...shape.size);
    const half = new THREE.Matrix4().makeScale(0.5, 0.5, 0.5);
    if (shape.kind === "mesh")
      this.mesh(shape.mesh, new THREE.MeshPhongMaterial({ color })).traverse((child) => {
        child.updateMatrixWorld(true);
        if (child.isMesh) this.push({ geometry: child.geometry, color, opacity: a, track: shape.track, local: scale.clone().multiply(child.matrixWorld) });
      });
    else if (shape.kind === "box") this.push({ geometry: PRIMITIVES.BoxGeometry, color, opacity: a, track: shape.track, local: scale });
    else if (shape.kind === "sphere")
      this.push({ geometry: PRIMITIVES.SphereGeometry, color, opacity: a, track: shape.track, local: scale.multiply(half) });
    else {
      const upright = new THREE.Matrix4().makeRotationX(Math.PI / 2).multiply(new THREE.Matrix4().makeScale(0.5, 1, 0.5));
      this.push({ geometry: PRIMITIVES.CylinderGeometry, color, opacity: a, track: shape.track, local: scale.multiply(upright) });
    }
  }

  push(item) {
    if (!item.geometry.attributes.normal) item.geometry.computeVertexNormals();
    if (!item.geometry.boundingBox) item.geometry.computeBoundingBox();
    const box = item.geometry.boundingBox.clone().applyMatrix4(item.local);
    if (![...box.min, ...box.max].every(Number.isFinite)) return;
    this.boxes[item.track] = (this.boxes[item.track] ?? new THREE.Box3()).union(box);
    this.items.push(item);
  }

  // One InstancedMesh for all items of the same geometry and opacity; of each track the places of its items.
  batch() {
    const batches = new Map();
    for (const item of this.items) {
      const key = `${item.geometry.uuid} ${item.opacity}`;
      if (!batches.has(key)) batches.set(key, []);
      batches.get(key).push(item);
    }
    this.places = Array.from({ length: this.tracks.count }, () => []);
    for (const items of batches.values()) {
      const opacity = items[0].opacity;
      const material = new THREE.MeshStandardMaterial({ roughness: 0.75, metalness: 0.05, side: THREE.DoubleSide, opacity, transparent: opacity < 1 });
      const mesh = new THREE.InstancedMesh(items[0].geometry, material, items.length);
      mesh.frustumCulled = false;
      mesh.userData.opacity = opacity;
      items.forEach((item, number) => {
        mesh.setColorAt(number, item.color);
        mesh.setMatrixAt(number, NOWHERE);
        this.places[item.track].push({ mesh, number, local: item.local });
      });
      this.group.add(mesh);
    }
  }

  // Moves what has moved since the last call.
  show(frame) {
    const position = new THREE.Vector3(), quaternion = new THREE.Quaternion(), one = new THREE.Vector3(1, 1, 1);
    const pose = new THREE.Matrix4(), placed = new THREE.Matrix4();
    for (let track = 0; track < this.tracks.count; ++track) {
      if (this.tracks.pose(track, frame, position, quaternion)) pose.compose(position, quaternion, one);
      else pose.copy(NOWHERE);
      if (this.known[track] && pose.equals(this.matrices[track])) continue;
      this.known[track] = 1;
      this.matrices[track].copy(pose);
      for (const { mesh, number, local } of this.places[track]) {
        mesh.setMatrixAt(number, placed.multiplyMatrices(pose, local));
        mesh.instanceMatrix.needsUpdate = true;
      }
    }
  }

  setOpacity(factor) {
    for (const mesh of this.group.children) {
      mesh.material.opacity = mesh.userData.opacity * factor;
      mesh.material.transparent = mesh.material.opacity < 1;
      mesh.material.depthWrite = mesh.material.opacity === 1;
      mesh.material.needsUpdate = true;
    }
  }

  // Where a thing is now; null where it is not there.
  center(thing) {
    const matrix = this.matrices[this.things[thing].track];
    return matrix.equals(NOWHERE) ? null : new THREE.Vector3().setFromMatrixPosition(matrix);
  }

  // Between the sizes of a typical body and of the largest one [m]; 0 without bodies.
  typicalSize() {
    const things = this.data.bodies.map((body) => body.links.map(({ track }) => track)).concat(this.data.shapes.map(({ track }) => [track]));
    const sizes = things.map((tracks) => largestEdge(this.box(tracks))).filter((size) => size > 0).sort((a, b) => a - b);
    return sizes.length ? Math.sqrt(sizes[(sizes.length - 1) >> 1] * sizes[sizes.length - 1]) : 0;
  }

  // Around what is drawn of tracks, in the world, where they are now; empty where they are not there.
  box(tracks = this.boxes.keys()) {
    const box = new THREE.Box3();
    for (const track of tracks)
      if (this.boxes[track] && !this.matrices[track].equals(NOWHERE)) box.union(this.boxes[track].clone().applyMatrix4(this.matrices[track]));
    return box;
  }
}

function largestEdge(box) {
  return box.isEmpty() ? 0 : Math.max(...box.getSize(new THREE.Vector3()).toArray());
}
