// Where light ends: at walls and at robots. The same geometry as sim/arena/light.py.

/** Distance along the ray from (x, y) at `angle` to a wall [x1, y1, x2, y2]; Infinity if it misses. */
export function rayToWall(x, y, angle, [x1, y1, x2, y2]) {
  const [dx, dy, wx, wy] = [Math.cos(angle), Math.sin(angle), x2 - x1, y2 - y1];
  const cross = dx * wy - dy * wx;
  if (Math.abs(cross) < 1e-12) return Infinity;
  const [ox, oy] = [x1 - x, y1 - y];
  const distance = (ox * wy - oy * wx) / cross;
  const along = (ox * dy - oy * dx) / cross;
  return distance >= 0 && along >= 0 && along <= 1 ? distance : Infinity;
}

/** Distance along the ray to a disc; Infinity if it misses. */
export function rayToDisc(x, y, angle, disc, radius) {
  const [ox, oy] = [disc.x - x, disc.y - y];
  const ahead = ox * Math.cos(angle) + oy * Math.sin(angle);
  const outside = ox * ox + oy * oy - radius * radius;
  if (outside <= 0) return 0;
  const root = ahead * ahead - outside;
  return ahead > 0 && root >= 0 ? ahead - Math.sqrt(root) : Infinity;
}

/**
 * A fan of `count` + 1 rays over `half` rad on either side of `heading`:
 * [{angle, distance, robot}], robot = the one that ends the ray, or null.
 */
export function fan(x, y, heading, half, count, range, walls, robots, radius) {
  return Array.from({ length: count + 1 }, (_, n) => {
    const angle = heading + half * ((2 * n) / count - 1);
    let distance = range;
    let robot = null;
    for (const wall of walls) distance = Math.min(distance, rayToWall(x, y, angle, wall));
    for (const other of robots) {
      const reached = rayToDisc(x, y, angle, other, radius);
      if (reached < distance) [distance, robot] = [reached, other];
    }
    return { angle, distance, robot };
  });
}
