// An invented run: its scenes, parameters, frames and figures.

const SCENES = [
  ["tear", "Notched bar", "pulled apart, Rankine", 20480, {}],
  [
    "crush",
    "Crushed block",
    "pressed in a frame, von Mises",
    20104,
    { half: 0.3, height: 0.2, depth: 0.2 },
  ],
  ["bone", "Bone", "pulled apart", 31220, { half: 0.45, height: 0.12, depth: 0.12 }],
  [
    "twist",
    "Twisted bar",
    "turned by 270 degrees, Rankine",
    24576,
    { half: 0.4, height: 0.09, depth: 0.09 },
  ],
  ["sheet", "Torn sheet", "thin plate, notched", 60000, { half: 0.4, height: 0.24, depth: 0.03 }],
].map(([name, title, description, particles, shape]) => ({
  name,
  title,
  description,
  particles,
  shape,
}));

const parameter = (group, id, label, unit, value, min, max, more = {}) => ({
  id,
  label,
  unit,
  value,
  default: value,
  min,
  max,
  scale: "linear",
  help: "",
  applies: "live",
  group,
  ...more,
});

const parameters = () => [
  parameter("Material", "tau_c", "Yield threshold", "Pa", 2e4, 2e3, 2e5, {
    scale: "log",
    hero: true,
    help: "Lower tears sooner.",
  }),
  parameter("Material", "softening", "Softening", "Pa", 1e5, 0, 4e5, {
    help: "Threshold lost per unit of plastic stretch.",
  }),
  parameter("Material", "youngs_modulus", "Young's modulus", "Pa", 1e5, 1e4, 1e7, {
    scale: "log",
    applies: "reset",
  }),
  parameter("Fracture", "stretch", "Stretch threshold", "×", 1.35, 1.05, 3, {
    applies: "postprocess",
  }),
  parameter("Fracture", "smoothing", "Smoothing", "passes", 5, 0, 20, {
    step: 1,
    applies: "postprocess",
  }),
  parameter("Solver", "cfl", "Courant number", "", 0.6, 0.05, 1, {}),
  parameter("Solver", "transfer", "Transfer", "", "apic", 0, 0, {
    choices: ["pic", "apic", "flip"],
    applies: "reset",
  }),
  parameter("View", "cutaway", "Cutaway", "%", 0, 0, 100, { step: 1 }),
];

/// One invented run: `frames` frames at 24 per second, one recorded every `frame_ms` while playing.
export class MockRun {
  constructor({ frames = 120, frame_ms = 70, most_width = 240 } = {}) {
    Object.assign(this, {
      frames,
      frame_ms,
      most_width,
      revision: 1,
      frame: 0,
      status: "paused",
      scene: "tear",
      reason: null,
      energy_warning: null,
      progress: null,
      uploads: [],
      patches: [],
      actions: [],
      pull: null,
      pulls: [],
      probes: [],
      looking: null,
      heard: 0, // the newest revision that the page knows
      exported: null,
      export_held: false,
      orders: [],
      frame_requests: [],
      patch_ms: 0,
      picture_ms: 0,
      patches_in_flight: 0,
      most_patches_in_flight: 0,
      down: false,
      bare: false,
    });
    this.parameters = parameters();
    this.waiting = new Set();
    this.timer = setInterval(() => {
      if (this.status === "playing") this.advance();
    }, frame_ms);
  }

  changed() {
    this.revision++;
    for (const wake of this.waiting) wake();
    this.waiting.clear();
  }

  /// Resolves at the next change, or after `ms`.
  change_within(ms) {
    return new Promise((resolve) => {
      const timer = setTimeout(resolve, ms);
      this.waiting.add(() => {
        clearTimeout(timer);
        resolve();
      });
    });
  }

  advance() {
    if (this.frame >= this.frames) this.status = "finished";
    else this.frame++;
    this.changed();
  }

  set(values) {
    Object.assign(this, values);
    this.changed();
  }

  get scenes() {
    return [
      ...SCENES,
      ...this.uploads.map((name) => ({
        ...SCENES[2],
        name,
        title: name,
        description: "your mesh",
      })),
    ];
  }

  get share() {
    return this.frame / this.frames;
  }

  state() {
    const { title, description, particles } = this.scenes.find(({ name }) => name === this.scene);
    const events = [
      [Math.round(0.38 * this.frames), "first yield"],
      [Math.round(0.6 * this.frames), "two pieces"],
    ]
      .filter(([frame]) => frame <= this.frame)
      .map(([frame, name]) => ({ frame, name }));
    const { revision, scene, status, reason, energy_warning, progress, frame, frames } = this;
    if (this.bare) return { revision, scene, status, progress, frame: 0, events: [], notes: [], message: "" };
    return {
      revision,
      scene,
      title,
      description,
      status,
      message: reason?.text ?? "",
      reason,
      energy_warning,
      progress,
      frame,
      frames,
      time: frame / 24,
      frame_rate: 24,
      particles,
      substeps: 35,
      dt: 1.19e-3,
      realtime_factor: 0.58,
      frames_per_second: 14,
      seconds: { simulate: 0.041, remesh: 0.012, render: 0.015, encode: 0.003 },
      ...this.counts(frame),
      view: this.view,
      camera: { eye: [-1.15, 0.95, 1.75], target: [0, 0.27, 0], fov: 30 },
      events,
      grip: { radius: 0.06, strength: 40 },
      pull: this.pull,
      notes: [
        "The body is split into 20,480 particles on 8 per cell.",
        "Surface particles lie on the surface.",
      ],
    };
  }

  counts(frame) {
    const share = frame / this.frames,
      broken = Math.round(3120 * Math.max(0, Math.min(1, (share - 0.42) / 0.3)) ** 2);
    return {
      broken_edges: broken,
      pieces: share > 0.6 ? 2 : 1,
      yielded: broken * 2,
      damaged: broken,
    };
  }

  series(from) {
    const frames = Array.from({ length: Math.max(0, this.frame - from + 1) }, (_, i) => from + i);
    const column = (f) => frames.map((frame) => f(frame / this.frames, frame));
    const elastic = (t) =>
      t < 0.6 ? 30 * Math.min(0.9, (t * 3) ** 1.5) : 6 + 20 * Math.exp(-(t - 0.6) * 30);
    return {
      from,
      frames,
      columns: {
        time: column((t, frame) => frame / 24),
        kinetic_energy: column((t) => 1 + (t > 0.6 ? 12 * Math.exp(-(t - 0.6) * 10) : 0)),
        elastic_energy: column(elastic),
        dissipated_energy: column((t) => 34 * Math.max(0, Math.min(1, (t - 0.35) / 0.4))),
        affine_energy: column(() => 0.02),
        start_energy: column(() => 0),
        gravity_change: column(() => 0),
        friction_energy: column(() => 0),
        external_work: column((t) => 42 * Math.min(1, t / 0.6)),
        transfer_loss: column((t) => 3 * t),
        energy_drift: column((t) => 0.07 * t),
        momentum_x: column((t) => 0.4 * Math.sin(9 * t)),
        momentum_y: column((t) => -0.2 * t),
        momentum_z: column(() => 0),
        broken_edges: column((t, frame) => this.counts(frame).broken_edges),
        pieces: column((t, frame) => this.counts(frame).pieces),
        sim_seconds: column(() => 0.041),
        post_seconds: column(() => 0.012),
        render_seconds: column(() => 0.015),
      },
    };
  }

  patch(values) {
    const bad = [];
    for (const [id, value] of Object.entries(values)) {
      const known = this.parameters.find((entry) => entry.id === id);
      const fits =
        known &&
        (known.choices ? known.choices.includes(value) : value >= known.min && value <= known.max);
      if (!fits)
        bad.push({ pointer: `/values/${id}`, detail: `${value} is not allowed for ${id}` });
    }
    if (bad.length) return bad;
    for (const [id, value] of Object.entries(values))
      this.parameters.find((entry) => entry.id === id).value = value;
    this.changed();
    return [];
  }

  /// Holds the answers of probes back until the function that it returns is called.
  hold_probes() {
    let answer;
    this.looking = new Promise((done) => (answer = done));
    return answer;
  }

  /// The body fills the middle of the picture; what it says of its matter depends on the place.
  probe(query) {
    const [x, y] = ["x", "y"].map((name) => Number(query.get(name)));
    this.probes.push({ x, y, frame: query.get("frame") });
    if (Math.abs(x - 0.5) > 0.2 || Math.abs(y - 0.5) > 0.2) return { frame: this.frame, matter: null };
    return {
      frame: this.frame,
      matter: {
        position: [0.1, 0.27, 0],
        rest: [0.08, 0.25, 0],
        velocity: [0.3, 0, 0.08],
        material: "clay",
        particle: 12044,
        piece: 2,
        crack: false,
        damage: 0.62,
        threshold: 7600,
        stress: 5200,
        share_of_break_threshold: 0.31,
        yielded: true,
      },
    };
  }

  /// A job of which one frame more is done with every look at it, but no second one while it is held.
  start_export(order, query) {
    this.orders.push({ ...order, w: Number(query.get("w")), eye: query.get("eye") });
    const { format, first, last } = order;
    const id = (this.exported?.id ?? 0) + 1;
    this.exported = { id, status: "running", name: `tear-${format}`, done: 0, of: last - first + 1 };
    return id;
  }

  look_at_export() {
    const job = this.exported;
    if (job.status === "running" && !(this.export_held && job.done) && ++job.done >= job.of)
      job.status = "done";
    return { ...job, seconds_left: 0.4 * (job.of - job.done), bytes: 48.2e6, reason: "the disk is full" };
  }

  act_on(pull) {
    this.pulls.push(pull);
    const { radius, at = this.pull?.at, target } = pull;
    this.pull = radius ? { at, target, radius, force: [3, 4, 0] } : null;
    if (radius && this.status === "paused") this.status = "playing";
    this.changed();
  }

  act(name, body) {
    this.actions.push({ name, ...body });
    if (name === "play" && this.status === "paused") this.status = "playing";
    else if (name === "pause" && this.status === "playing") this.status = "paused";
    else if (name === "reset") Object.assign(this, { frame: 0, status: "paused", reason: null });
    else if (name === "step") {
      if (this.frame < this.frames) this.frame += body.frames ?? 1;
      this.status = this.frame >= this.frames ? "finished" : "paused";
    }
    this.changed();
  }

  close() {
    clearInterval(this.timer);
  }
}
