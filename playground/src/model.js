// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A mesh with its tree in the page's module, and the bodies that follow it by one rule each.

const isView = (rule) => rule === 'rest';

export class Model {
  /** made: of Builder.build(); character: of character.js, or null. */
  constructor(morula, made, character) {
    this.morula = morula;
    this.mesh = new morula.Mesh(made.positions, made.facets);
    this.tree = morula.Tree.fromBytes(made.tree, this.mesh);
    this.rest = made.positions;
    this.facets = made.facets;
    this.clusters = made.clusters;
    this.skin = character?.followsBones ? new morula.Skin(4, character.bones, character.weights, character.boneCount) : null;
    this.nodeCount = this.tree.nodeCount;
    this.levelCount = this.tree.levelCount;
    this.levelSets = Array.from({ length: this.levelCount }, (_, level) => this.tree.levelSet(level));
    this.restSpheres = Float32Array.from(this.tree.spheres);
    this.arrange(this.tree.parent.slice());
    this.bodies = new Map();
  }

  /** Level of each node, and which child of the root it is below. */
  arrange(parent) {
    this.levelOf = new Uint8Array(this.nodeCount);
    this.branchOf = new Uint32Array(this.nodeCount);
    for (let node = 1; node < this.nodeCount; ++node) {
      this.levelOf[node] = this.levelOf[parent[node]] + 1;
      this.branchOf[node] = parent[node] === 0 ? node - 1 : this.branchOf[parent[node]];
    }
  }

  /** The body that follows by a rule; `rest`: one that is not updated, by which rays still find the surface. */
  body(rule) {
    const name = isView(rule) ? 'exact' : rule;
    if (!this.bodies.has(name)) {
      const skin = name === 'skinned' ? this.skin : null;
      this.bodies.set(name, new this.morula.Body(this.mesh, this.tree, { rules: name, skin }));
    }
    return this.bodies.get(name);
  }

  /** Moves the spheres of a rule to the positions, or with `skinned` to the transforms; writes them to `spheres`. */
  update(rule, positions, transforms, spheres) {
    const body = this.body(rule);
    if (rule === 'skinned') {
      body.positions.set(positions); // for rays
      body.transforms.set(transforms);
      body.updateSkinned();
    } else {
      body.positions.set(positions);
      body.update();
    }
    spheres.set(isView(rule) ? this.restSpheres : body.spheres());
  }

  /** Microseconds per update of all levels: the least of some runs, each long enough for the page's clock. */
  measureUpdate(rule) {
    const body = this.body(rule);
    const update = rule === 'skinned' ? () => body.updateSkinned() : () => body.update();
    let least = Infinity;
    for (let run = 0; run < 3; ++run) {
      let count = 0;
      const begin = performance.now();
      do {
        update();
        ++count;
      } while (performance.now() - begin < 2);
      least = Math.min(least, (performance.now() - begin) / count);
    }
    return 1000 * least;
  }

  free() {
    for (const thing of [...this.bodies.values(), this.skin, this.tree, this.mesh]) thing?.free();
  }
}

/** The scene for the views of viewer/: one frame that changes in place. */
export class Shown {
  constructor(model, size) {
    this.motion = { frames: [Float32Array.from(model.rest)], facets: model.facets };
    this.step = [1, 1, 1];
    this.origin = [0, 0, 0];
    // The picture has single precision: far from the origin it rounds more.
    this.tolerance = 2e-6 * size + 5e-7 * model.rest.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
    this.frames = [model.restSpheres.slice()];
    this.levelSets = model.levelSets;
  }
  positions() {
    return this.motion.frames[0];
  }
}
