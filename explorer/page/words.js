// A diagnosis in one sentence: the same as in results/diagnosis.py, whose texts the page has in `words`.

class Sentence {
  constructor(diagnosis, words) {
    Object.assign(this, { d: diagnosis, words });
    const { contacts } = diagnosis;
    this.rows = contacts.body.map((_, i) =>
      Object.fromEntries(Object.entries(contacts).map(([name, column]) => [name, column[i]])));
    this.onBelly = this.rows.filter((row) => row.body_kind === words.belly);
    this.onTrack = this.rows.filter((row) => row.body_kind !== words.belly);
  }

  // Each clause states one fact; facts that follow from the outcome or from another clause are left out.
  text() {
    const { d } = this;
    const clauses = [this.ground(), this.bearers(), this.belly(), this.drives(), this.creep(), this.balance()];
    const facts = [this.head(), clauses.filter(Boolean).join("; ")].filter(Boolean).join(": ");
    if (d.transient) return `${facts}. ${this.continuation()}`;
    const tried = d.trials.map((each) => this.trial(each)).filter(Boolean).join("; ");
    return tried ? `${facts}. Tried: ${tried}${this.beltLimit()}` : facts;
  }

  head() {
    const { d } = this;
    if (d.transient) return `temporarily ${spaced(d.symptom)}`;
    const where = d.outcome === "seized" && d.intrusion ? this.where(d.intrusion) : "";
    const side = this.bellySide();
    const onEnd = d.outcome === "hung_up" && ["tail", "nose"].includes(side);
    return `${spaced(d.outcome)}${where}${onEnd ? ` on the ${side} of its hull` : ""}`;
  }

  // Where the ground pushes against the belly: at an end if it pushes more along the belly than away from its underside.
  bellySide() {
    if (!this.onBelly.length) return "";
    const [x, y] = ["normal_x", "normal_y"].map((name) =>
      this.onBelly.reduce((sum, row) => sum + row.normal_force * row[name], 0));
    const [along, across] = rotated([x, y], -this.d.chassis_angle);
    if (Math.abs(along) <= across) return "underside";
    return along > 0 ? "tail" : "nose";
  }

  // Which ground is inside the track, and where, unless the outcome already says so.
  ground() {
    const { d, words } = this;
    const piece = d.intrusion;
    if (!piece) return "";
    const where = d.outcome === "seized" && !d.transient ? "" : this.where(piece);
    let roots = "";
    if (this.hasGrousers(piece) && piece.bodies[0] !== piece.bodies[1]) {
      const past = piece.root_depth > words.least_depth;
      roots = ` (${past ? `${millimetres(piece.root_depth)} mm past` : "not as far as"} the grouser roots)`;
    }
    return `the ground at ${spot(piece.x, piece.y)} stands ${millimetres(piece.depth)} mm inside `
      + `${track(piece)}${roots}${where}`;
  }

  hasGrousers(piece) {
    return piece.depth - piece.root_depth > this.words.least_depth;
  }

  // The bodies between which a piece of ground is.
  where(piece) {
    const { names, in_chain: inChain } = this.words;
    const [rear, front] = [...piece.bodies].sort((a, b) => a - b);
    const [kind, other] = piece.body_kinds;
    const chained = inChain.includes(kind);
    if (rear !== front && chained) {
      const second = kind === other ? "the next" : names[other];
      return ` under the shoes between ${names[kind]} and ${second}`;
    }
    if (rear !== front) return ` between wheels ${rear} and ${front}`;
    if (chained) return " between two shoes";
    const name = names[kind] ?? `wheel ${rear}`;
    return this.hasGrousers(piece) ? ` between two grousers of ${name}` : ` at ${name}`;
  }

  // Which bodies bear on the ground inside the track, most loaded first.
  bearers() {
    const inside = this.rows.filter((row) => row.in_pocket);
    const loads = new Map();
    for (const row of inside) loads.set(row.body, (loads.get(row.body) ?? 0) + row.normal_force);
    const all = [...loads.values()].reduce((sum, load) => sum + load, 0);
    const bodies = [...loads.keys()].sort((a, b) => loads.get(b) - loads.get(a)).slice(0, 2)
      .filter((body) => loads.get(body) >= this.words.least_fraction * all);
    if (!bodies.length) return "";
    const [one, two] = bodies.map((body) => {
      const sliding = inside.filter((row) => row.body === body && row.slides)
        .reduce((sum, row) => sum + row.normal_force, 0);
      const load = loads.get(body);
      return { name: this.body(body), slides: sliding > 0.5 * load, newtons: `${fixed(load, 0)} N` };
    });
    if (two && two.name === one.name) two.name = "another";
    const verb = ({ slides }) => (slides ? "slides on it under a load of" : "bears on it with");
    let text = `${one.name} ${verb(one)} ${one.newtons}`;
    if (two && one.slides !== two.slides) text += ` and ${two.name} ${verb(two)} ${two.newtons}`;
    else if (two) text += `, ${two.name} ${two.slides ? "under" : "with"} ${two.newtons}`;
    return text + (this.words.grips[this.d.mechanism] ?? "");
  }

  body(body) {
    const row = this.rows.find((each) => each.body === body);
    return (row && this.words.names[row.body_kind]) ?? `wheel ${body}`;
  }

  belly() {
    const { d, words } = this;
    if (d.belly_share < words.least_fraction) return "";
    const side = this.bellySide();
    const part = ["tail", "nose"].includes(side) ? `the ${side}` : "the belly";
    const text = `${part} carries ${percent(d.belly_share)} of the supporting force`;
    if (d.outcome !== "hung_up" || !this.onBelly.length) return text;
    return `${text} at ${spot(...["x", "y"].map((name) => mean(this.onBelly, (row) => row[name])))}`;
  }

  // State of motors and surfaces, unless the ground inside the track implies it.
  drives() {
    const { d } = this;
    if (d.stalled_share > 0) {
      const of = d.stalled_share === 1 ? "" : `${percent(d.stalled_share)} of `;
      return `${of}the motors are at their torque limit`;
    }
    if (d.symptom === "cycling") return "it moves back and forth";
    if (d.outcome !== "slipping" || !this.onTrack.some((row) => row.normal_force > 0)) return "";
    const slip = mean(this.onTrack, (row) => Math.abs(row.surface_speed));
    return slip > this.words.least_slip ? `the track slips at ${fixed(slip, 2)} m/s` : "";
  }

  creep() {
    const { progress } = this.d;
    return progress < this.words.least_fraction ? ""
      : `it still creeps at ${percent(progress)} of the commanded speed`;
  }

  balance() {
    const { certified, imbalance } = this.d;
    if (certified) return "";
    if (imbalance === null) return "the balance of forces could not be computed";
    return `no contact forces balance it: the smallest residual is ${twoDigits(100 * imbalance)} % of the weight`;
  }

  // Which control trial got out of a transient stop.
  continuation() {
    const control = this.d.trials.find((each) => each.freed);
    const text = control.name === "unchanged" ? "It goes on by itself" : "With its track rebuilt it goes on";
    return `${text}: ${this.result(control)}`;
  }

  // Says if no belt that was tried from the start came to the stop, or none got past it.
  beltLimit() {
    const starts = this.d.trials.filter(fromTheStart);
    const isPast = (each) =>
      each.freed || (["tipped_over", "left_terrain"].includes(each.outcome) && each.distance > 0);
    if (!starts.length || starts.some(isPast)) return "";
    const reached = starts.some((each) => each.distance >= 0);
    return `. No belt ${reached ? "got past here" : "came this far"} from the start`;
  }

  // The change and the result of a trial; empty for a control.
  trial(tried) {
    const change = this.words.changes[tried.name];
    return change ? `${change}: ${this.result(tried)}` : "";
  }

  result(tried) {
    const end = this.end(tried);
    let text;
    if (tried.freed) {
      text = `${fromTheStart(tried) ? "past here" : "free"} after ${fixed(tried.time, 1)} s`;
      if (tried.outcome !== "timed_out") text += `, then ${end}`;
    } else if (fromTheStart(tried)) text = `${end} ${this.advance(tried) || "here"}`;
    else if (tried.outcome === "timed_out") text = "still moving, but not free";
    else {
      const isPlaced = tried.distance < 0 || this.isJammedElsewhere(tried);
      const further = isPlaced ? "" : this.advance(tried);
      text = further ? `${end} ${further}` : end;
    }
    return tried.starts > 1 ? `${text} (${tried.freeing} of ${tried.starts} times free)` : text;
  }

  // How far ahead or short of the stop a trial ended.
  advance({ distance }) {
    if (Math.abs(distance) < this.words.least_depth) return "";
    return `${millimetres(Math.abs(distance))} mm ${distance > 0 ? "further on" : "short of here"}`;
  }

  end(tried) {
    const { intrusion: jam } = tried;
    if (!tried.jammed) return this.words.ends[tried.outcome];
    if (!jam) return "is jammed";
    if (this.isJammedElsewhere(tried)) {
      return `is jammed${this.where(jam)}, in ${track(jam)} at ${spot(jam.x, jam.y)}`;
    }
    const bodies = (piece) => [...piece.bodies].sort((a, b) => a - b).join();
    const was = this.d.intrusion;
    return was && bodies(was) === bodies(jam) ? "is jammed again" : `is jammed again,${this.where(jam)}`;
  }

  // Whether a trial ended in a jam at another edge, or in another track, than the stop.
  isJammedElsewhere({ jammed, intrusion: jam }) {
    const { jammed: wasJammed, intrusion: was } = this.d;
    if (!jammed || !jam) return false;
    return !wasJammed || !was || ["side", "carrier", "edge"].some((name) => jam[name] !== was[name]);
  }
}

const fromTheStart = ({ name }) => name.endsWith(", from the start");
const spaced = (name) => name.replaceAll("_", " ");

function track({ side, carrier }) {
  const which = side === "both" ? "" : `${side} `;
  return carrier === "chassis" ? `the ${which}track` : `the track of the ${which}${carrier}`;
}

// The mean over contacts, weighted by their normal forces.
function mean(rows, value) {
  const all = rows.reduce((sum, row) => sum + row.normal_force, 0);
  return rows.reduce((sum, row) => sum + row.normal_force * value(row), 0) / all;
}

// A number with a number of decimals, without the sign of a zero.
const fixed = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "");
const millimetres = (length) => fixed(1e3 * length, 0);
const percent = (fraction) => `${fixed(100 * fraction, 0)} %`;
const spot = (x, y) => `x = ${fixed(x, 3)} m, y = ${fixed(y, 3)} m`;

// Two significant digits, as Python's "g" writes them.
function twoDigits(value) {
  const [digits, power] = value.toExponential(1).split("e").map(Number);
  if (power >= -4 && power < 2) return String(Number(value.toPrecision(2)));
  return `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}
