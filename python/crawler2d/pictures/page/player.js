// The time that a page shows, and the play button.

const element = (id) => document.getElementById(id);

class Player {
  // `draw` shows an instant; `snap` returns the instant at which a pause stops.
  constructor(draw, snap = (time) => time) {
    Object.assign(this, { draw, snap, time: 0, begin: 0, end: 0, playing: false, queued: false });
    element("play").addEventListener("click", () => this.play(!this.playing));
  }

  changed() {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.queued = false;
    if (this.playing) {
      const passed = Math.max(0, now - this.drawn) / 1000;
      this.drawn = now;
      this.time = Math.min(this.end, this.time + passed * Number(element("speed").value));
      if (this.time >= this.end) this.play(false);
      else this.changed();
    }
    this.draw(this.time);
  }

  play(on) {
    this.playing = on;
    if (!on) this.time = this.snap(this.time);
    else if (this.time >= this.end) this.time = this.begin;
    this.drawn = performance.now();
    element("play").setAttribute("aria-label", on ? "pause" : "play");
    element("play-shape").setAttribute("d", on ? "M3 2.5h3.6v11H3zM9.4 2.5H13v11H9.4z" : "M4 2.5v11l9-5.5z");
    this.changed();
  }

  // Goes to an instant and pauses there.
  seek(time) {
    this.time = time;
    if (this.playing) this.play(false);
    this.changed();
  }
}

// Gives a canvas the pixels of its size on the page, and passes that size to what draws on it.
function fit(canvas, part) {
  const { clientWidth, clientHeight } = canvas;
  canvas.width = Math.max(1, Math.round(clientWidth * (window.devicePixelRatio || 1)));
  canvas.height = Math.max(1, Math.round(clientHeight * (window.devicePixelRatio || 1)));
  part.resize(Math.max(1, clientWidth), Math.max(1, clientHeight));
}
