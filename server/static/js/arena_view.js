export class ArenaView {
  constructor({ frame, url }) { frame.src = url; frame.hidden = false; }
  show() {}
}
