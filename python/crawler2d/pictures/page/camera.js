// From metres to pixels: the visible part of the ground, and its scale.

class Camera {
  constructor(extent, robotLength) {
    [this.left, this.right, this.bottom, this.top] = extent;
    this.robotLength = robotLength;
    this.width = this.height = 1;
    this.scale = 1; // pixels per metre
    this.x = this.y = 0; // centre of the view; relative to the robot while it is followed
    this.follows = this.right - this.left > 5 * robotLength;
    this.touched = false;
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    if (!this.touched) this.reset();
  }

  reset() {
    this.touched = false;
    if (this.follows) {
      this.scale = Math.min(this.width / (2.4 * this.robotLength), this.height / (1.3 * this.robotLength));
      // More space ahead than behind, more sky than ground.
      this.x = 0.15 * this.robotLength;
      this.y = 0.12 * this.robotLength;
      return;
    }
    const wide = this.right - this.left;
    const high = this.top - this.bottom;
    this.scale = Math.min(this.width / wide, this.height / high);
    this.x = (this.left + this.right) / 2;
    this.y = (this.top + this.bottom) / 2;
  }

  follow(on, robot) {
    if (on === this.follows) return;
    this.follows = on;
    if (on) this.reset();
    else {
      this.x += robot.x;
      this.y += robot.y;
      this.touched = true;
    }
  }

  // Sets the centre of the view for the current position of the robot.
  look(robot) {
    this.middleX = this.x + (this.follows ? robot.x : 0);
    this.middleY = this.y + (this.follows ? robot.y : 0);
  }

  screen(x, y) {
    return [
      this.width / 2 + (x - this.middleX) * this.scale,
      this.height / 2 - (y - this.middleY) * this.scale,
    ];
  }

  // Shows at least a margin round two points, and no less than before.
  include([x, y], [otherX, otherY]) {
    const reach = this.robotLength;
    const sees = (px, py) => {
      const [sx, sy] = this.screen(px, py);
      const margin = 0.5 * reach * this.scale;
      return sx > margin && sx < this.width - margin && sy > 0 && sy < this.height;
    };
    if (sees(x, y) && sees(otherX, otherY)) return;
    const wide = Math.abs(x - otherX) + 2 * reach;
    const high = Math.abs(y - otherY) + 1.2 * reach;
    this.follows = false;
    this.touched = true;
    this.scale = Math.min(this.width / wide, this.height / high);
    this.x = (x + otherX) / 2;
    this.y = (y + otherY) / 2;
  }

  drag(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
    this.touched = true;
  }

  // Zooms about a pixel: the point under it stays there.
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const widest = 4 * Math.max(this.right - this.left, 2 * this.robotLength);
    const least = this.width / widest;
    const most = this.width / (0.01 * this.robotLength);
    const scale = Math.min(most, Math.max(least, this.scale * factor));
    const shift = 1 / this.scale - 1 / scale;
    this.x += (px - this.width / 2) * shift;
    this.y -= (py - this.height / 2) * shift;
    this.scale = scale;
    this.touched = true;
  }

  // Lets a context draw in metres.
  apply(ctx, ratio) {
    const s = this.scale * ratio;
    const [x, y] = this.screen(0, 0);
    ctx.setTransform(s, 0, 0, -s, x * ratio, y * ratio);
  }
}
