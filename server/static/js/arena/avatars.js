// The players' pictures, each loaded once.

const MOST = 64; // pictures kept
const SIZE = 96; // pixels; the addresses may lead to pictures of any size

export class Avatars {
  #pictures = new Map(); // address -> canvas, null until it is there

  /** The picture at this address as a square canvas; null while it is not there. `onLoad()` tells when it is. */
  get(address, onLoad) {
    if (!address) return null;
    if (!this.#pictures.has(address)) {
      if (this.#pictures.size >= MOST) this.#pictures.delete(this.#pictures.keys().next().value);
      this.#pictures.set(address, null);
      this.#load(address, onLoad);
    }
    return this.#pictures.get(address);
  }

  async #load(address, onLoad) {
    const image = new Image(SIZE, SIZE);
    image.src = address;
    try {
      await image.decode();
    } catch {
      return; // no picture: the name stands alone
    }
    const canvas = new OffscreenCanvas(SIZE, SIZE);
    canvas.getContext("2d").drawImage(image, 0, 0, SIZE, SIZE);
    this.#pictures.set(address, canvas);
    onLoad();
  }
}
