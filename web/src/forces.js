// Contact forces as arrows, friction cones, and numbers beside them.
import * as THREE from "three";
import { MODE_COLORS } from "./colors.js";
import { typicalForce } from "./series.js";

const UP = new THREE.Vector3(0, 1, 0);
const SHAFT = 0.018, HEAD = 0.045, HEAD_LENGTH = 0.1, CONE_HEIGHT = 0.16; // in sizes of bodies
const SHORTEST = 0.08, LONGEST = 3; // arrows, in the same
const MOST_CONE = 2; // mu that a cone is drawn for
const LABELS = 40;

function instanced(geometry, material, count) {
  const mesh = new THREE.InstancedMesh(geometry, material, Math.max(count, 1));
  mesh.frustumCulled = false;
  mesh.count = 0;
  mesh.setColorAt(0, new THREE.Color());
  return mesh;
}

export class Forces {
  constructor(contacts, size, labelLayer) {
    Object.assign(this, { contacts, size });
    this.colors = MODE_COLORS.map((color) => new THREE.Color(color));
    this.base = size / (2 * typicalForce(contacts)); // [m/N]
    this.factor = 1;
    const most = contacts.most, opaque = () => new THREE.MeshStandardMaterial({ roughness: 0.6 });
    this.shafts = instanced(new THREE.CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0), opaque(), most);
    this.heads = instanced(new THREE.ConeGeometry(1, 1, 16).translate(0, 0.5, 0), opaque(), most);
    const cone = new THREE.ConeGeometry(1, 1, 24, 1, true).rotateX(Math.PI).translate(0, 0.5, 0); // tip at the contact
    const glass = new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false });
    this.cones = instanced(cone, glass, most);
    this.group = new THREE.Group().add(this.shafts, this.heads, this.cones);
    this.runs = new Int32Array(Math.max(most, 1)); // of each arrow
    this.labels = Array.from({ length: LABELS }, () => {
      const label = document.createElement("div");
      label.className = "label";
      labelLayer.append(label);
      return label;
    });
    this.numbers = false;
  }

  // [m/N] of the arrows
  get scale() {
    return this.base * this.factor;
  }

  set conesShown(on) {
    this.cones.visible = on;
  }

  show(frame) {
    const contacts = this.contacts, size = this.size;
    const place = new THREE.Vector3(), direction = new THREE.Vector3(), scale = new THREE.Vector3();
    const turn = new THREE.Quaternion(), matrix = new THREE.Matrix4();
    const [x, y, z] = contacts.position, [nx, ny, nz] = contacts.normal, [fx, fy, fz] = contacts.force;
    let arrows = 0, cones = 0;
    contacts.at(frame, (run) => {
      const color = this.colors[contacts.mode[run]] ?? this.colors[0];
      place.set(x[run], y[run], z[run]);
      direction.set(nx[run], ny[run], nz[run]);
      const height = CONE_HEIGHT * size, radius = Math.min(contacts.friction[run], MOST_CONE) * height;
      turn.setFromUnitVectors(UP, direction.normalize());
      this.cones.setMatrixAt(cones, matrix.compose(place, turn, scale.set(radius, height, radius)));
      this.cones.setColorAt(cones++, color);
      if (!(contacts.size[run] > 0)) return;
      direction.set(fx[run], fy[run], fz[run]).normalize();
      turn.setFromUnitVectors(UP, direction);
      const length = Math.min(Math.max(contacts.size[run] * this.scale, SHORTEST * size), LONGEST * size);
      const head = Math.min(HEAD_LENGTH * size, 0.5 * length);
      this.shafts.setMatrixAt(arrows, matrix.compose(place, turn, scale.set(SHAFT * size, length - head, SHAFT * size)));
      place.addScaledVector(direction, length - head);
      this.heads.setMatrixAt(arrows, matrix.compose(place, turn, scale.set(HEAD * size, head, HEAD * size)));
      this.shafts.setColorAt(arrows, color);
      this.heads.setColorAt(arrows, color);
      this.runs[arrows++] = run;
    });
    this.shafts.count = this.heads.count = arrows;
    this.cones.count = cones;
    for (const mesh of [this.shafts, this.heads, this.cones]) {
      mesh.instanceMatrix.needsUpdate = mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null; // else picking uses the last one
    }
  }

  // Numbers beside the largest arrows, on the screen.
  placeLabels(camera, width, height) {
    let used = 0;
    if (this.numbers && this.group.visible) {
      const matrix = new THREE.Matrix4(), place = new THREE.Vector3();
      const order = Array.from({ length: this.heads.count }, (_, arrow) => arrow)
        .sort((a, b) => this.contacts.size[this.runs[b]] - this.contacts.size[this.runs[a]]);
      for (const arrow of order.slice(0, LABELS)) {
        this.heads.getMatrixAt(arrow, matrix);
        place.setFromMatrixPosition(matrix).project(camera);
        if (Math.abs(place.z) > 1) continue;
        const label = this.labels[used++];
        label.textContent = `${this.contacts.size[this.runs[arrow]].toPrecision(3)} N`;
        label.style.transform = `translate(${(0.5 + 0.5 * place.x) * width}px, ${(0.5 - 0.5 * place.y) * height}px)`;
        label.hidden = false;
      }
    }
    for (; used < this.labels.length; ++used) this.labels[used].hidden = true;
  }

  // The contact whose arrow a ray meets first, or -1.
  pick(raycaster) {
    if (!this.group.visible) return -1;
    const [hit] = raycaster.intersectObjects([this.shafts, this.heads]);
    return hit ? this.runs[hit.instanceId] : -1;
  }
}
