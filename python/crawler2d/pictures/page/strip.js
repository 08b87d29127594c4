// Chassis angle and track speed over time, with stops, intrusions and the current time.

const GUTTER = 78;
const EVENTS_HEIGHT = 16;

class Strip {
  constructor(canvas, recording) {
    this.canvas = canvas;
    this.recording = recording;
    const degrees = recording.angle.map((angle) => (angle * 180) / Math.PI);
    this.rows = [
      { name: "angle", unit: "°", least: 5, lines: [[degrees, "angle"]] },
      { name: "track", unit: " m/s", least: 0.1, lines: [[recording.commanded, "quiet", true], [recording.speed, "speed"]] },
    ];
    for (const row of this.rows) {
      let [low, high] = [0, 0];
      for (const [values] of row.lines) {
        for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
      }
      high = Math.max(high, low + row.least); // keeps noise small
      const margin = 0.12 * (high - low);
      Object.assign(row, { low, high, bottom: low - margin, top: high + margin });
    }
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
  }

  pixel(time) {
    const { begin, end } = this.recording;
    return GUTTER + ((time - begin) / (end - begin || 1)) * (this.width - GUTTER - 10);
  }

  time(pixel) {
    const { begin, end } = this.recording;
    const share = (pixel - GUTTER) / (this.width - GUTTER - 10);
    return begin + Math.min(1, Math.max(0, share)) * (end - begin);
  }

  draw(now, colors) {
    const ctx = this.canvas.getContext("2d");
    const ratio = this.canvas.width / this.width;
    const { recording, height, width } = this;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    ctx.font = FONT;
    const bottom = height - EVENTS_HEIGHT - 18;
    const stopsFirst = [...recording.events].sort((a, b) => (b.kind === "stop") - (a.kind === "stop"));
    for (const event of stopsFirst) {
      const x = this.pixel(event.start);
      const wide = Math.max(2, this.pixel(event.end) - x);
      if (event.kind === "stop") {
        ctx.fillStyle = colors.stopFill;
        ctx.fillRect(x, 4, wide, height - 22);
        ctx.fillStyle = colors.stop;
        ctx.fillRect(x, 4, 2, height - 22);
      } else if (event.kind === "intrusion") {
        ctx.fillStyle = colors.intrusion;
        ctx.fillRect(x, bottom + 6, wide, 6);
      }
    }
    const gap = 8;
    const rowHeight = (bottom - 6 - gap) / 2;
    this.rows.forEach((row, i) => this.drawRow(ctx, row, 6 + i * (rowHeight + gap), rowHeight, colors));
    if (recording.events.some((e) => e.kind === "intrusion")) {
      ctx.fillStyle = colors.quiet;
      ctx.fillText("intrusion", 8, bottom + 13);
    }
    this.drawTimes(ctx, colors);
    const x = this.pixel(now);
    ctx.strokeStyle = colors.ink;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(x, 2);
    ctx.lineTo(x, height - 16);
    ctx.stroke();
  }

  drawRow(ctx, row, top, height, colors) {
    const y = (value) => top + ((row.top - value) / (row.top - row.bottom)) * height;
    ctx.fillStyle = colors.quiet;
    ctx.fillText(row.name, 8, top + height / 2 + 4);
    ctx.textAlign = "right";
    ctx.font = FONT.replace("12px", "10px");
    const digits = row.high - row.low >= 5 ? 0 : 1;
    const least = row.low.toFixed(digits);
    ctx.fillText(row.high.toFixed(digits) + row.unit, GUTTER - 4, top + 9);
    if (Number(least) < 0) ctx.fillText(least.replace("-", "−"), GUTTER - 4, top + height);
    ctx.textAlign = "left";
    ctx.font = FONT;
    ctx.strokeStyle = colors.line;
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(GUTTER, Math.round(y(0)) + 0.5);
    ctx.lineTo(this.width - 10, Math.round(y(0)) + 0.5);
    ctx.stroke();
    for (const [values, color, dashed] of row.lines) {
      ctx.strokeStyle = colors[color];
      ctx.lineWidth = 1.5;
      ctx.setLineDash(dashed ? [4, 3] : []);
      ctx.beginPath();
      for (let i = 0; i < values.length; i++) ctx.lineTo(this.pixel(this.recording.time[i]), y(values[i]));
      ctx.stroke();
    }
    ctx.setLineDash([]);
  }

  drawTimes(ctx, colors) {
    const { begin, end } = this.recording;
    const step = nice(((end - begin || 1) * 110) / (this.width - GUTTER));
    ctx.fillStyle = colors.quiet;
    ctx.textAlign = "center";
    const first = Math.ceil(begin / step);
    for (let k = first; k * step <= end + 1e-9; k++) {
      const text = `${+(k * step).toPrecision(6)}${k === first ? " s" : ""}`;
      ctx.fillText(text, Math.min(this.pixel(k * step), this.width - 14), this.height - 4);
    }
    ctx.textAlign = "left";
  }
}
