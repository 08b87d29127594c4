// Marks of both pictures, in pixels: arrows, diamonds, labels, and round numbers; their colours.

// [px] Arrow lengths of a typical large force and slip velocity; arrows are clipped at LONGEST times that.
const FORCE_LENGTH = 110;
const SPEED_LENGTH = 42;
const LONGEST = 1.6;
const FONT = "12px system-ui, -apple-system, 'Segoe UI', Roboto, Arial, sans-serif";

// The largest of 1, 2 or 5 times a power of ten that is not above the value.
function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const first = value / power;
  return (first >= 5 ? 5 : first >= 2 ? 2 : 1) * power;
}

function diamond(ctx, x, y, size, fill, stroke) {
  ctx.beginPath();
  ctx.moveTo(x, y - size);
  ctx.lineTo(x + size, y);
  ctx.lineTo(x, y + size);
  ctx.lineTo(x - size, y);
  ctx.closePath();
  ctx.fillStyle = fill;
  ctx.strokeStyle = stroke;
  ctx.lineWidth = 1.6;
  ctx.fill();
  ctx.stroke();
}

// An arrow that is too long is clipped and gets a double head. The y component points up.
function arrow(ctx, x, y, vx, vy, usual, color, halo) {
  const full = Math.hypot(vx, vy);
  if (!(full > 0.02 * usual)) return;
  const length = Math.min(full, LONGEST * usual);
  const head = Math.min(9, length);
  ctx.save();
  ctx.translate(x, y);
  ctx.rotate(Math.atan2(-vy, vx));
  const shape = new Path2D();
  shape.moveTo(0, 0);
  shape.lineTo(Math.max(0, length - head), 0);
  const heads = new Path2D();
  for (const tip of length < full ? [length, length + 8] : [length]) {
    heads.moveTo(tip, 0);
    heads.lineTo(tip - head, 0.42 * head);
    heads.lineTo(tip - head, -0.42 * head);
    heads.closePath();
  }
  ctx.lineJoin = ctx.lineCap = "round";
  ctx.strokeStyle = halo;
  ctx.lineWidth = 5;
  ctx.stroke(shape);
  ctx.lineWidth = 3;
  ctx.stroke(heads);
  ctx.strokeStyle = ctx.fillStyle = color;
  ctx.lineWidth = 2.4;
  ctx.lineCap = "butt";
  ctx.stroke(shape);
  ctx.fill(heads);
  ctx.restore();
}

function label(ctx, text, x, y, color, halo, width) {
  ctx.font = `600 ${FONT}`;
  const left = Math.max(4, Math.min(x, width - ctx.measureText(text).width - 6));
  ctx.lineJoin = "round";
  ctx.lineWidth = 4;
  ctx.strokeStyle = halo;
  ctx.strokeText(text, left, y);
  ctx.fillStyle = color;
  ctx.fillText(text, left, y);
}

// The colours of the style sheet, their names in camel case.
function readColors() {
  const style = getComputedStyle(document.documentElement);
  const names = [
    "ink", "quiet", "line", "ground", "ground-line", "grid", "track", "track-fill", "chassis",
    "chassis-fill", "halo", "force", "speed", "intrusion", "intrusion-fill", "stop", "stop-fill",
    "goal", "angle",
  ];
  const camel = (name) => name.replace(/-(.)/g, (_, letter) => letter.toUpperCase());
  const value = (name) => style.getPropertyValue(`--${name}`).trim();
  return Object.fromEntries(names.map((name) => [camel(name), value(name)]));
}
