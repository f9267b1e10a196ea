// How a robot that is offered makes itself heard, also where nobody looks at the page. Pure but for what it acts with.

const AGAIN = 4000; // ms from one call to the next
const BUZZ = [200, 100, 200]; // ms on, off, on

export class OfferCall {
  #speaker;
  #vibrate;
  #page;
  #notify;
  #title = null; // the page's own, while there is an offer
  #calledAt = 0;
  #note = null;

  /**
   * @param {object} wiring
   * @param {{play: (name: string) => void}} wiring.speaker
   * @param {(pattern: number[]) => void} wiring.vibrate
   * @param {{title: string}} wiring.page the document
   * @param {(title: string, text: string) => ({close: () => void}|null)} wiring.notify null where it is not allowed or not needed
   */
  constructor({ speaker, vibrate, page, notify }) {
    this.#speaker = speaker;
    this.#vibrate = vibrate;
    this.#page = page;
    this.#notify = notify;
  }

  get isOn() {
    return this.#title !== null;
  }

  /**
   * A robot is offered, or still is.
   * @param {{title: string, text: string, tab: string}} words `tab` is the title of the page meanwhile
   * @param {number} now ms
   */
  call({ title, text, tab }, now) {
    const isNew = !this.isOn;
    if (isNew) this.#title = this.#page.title;
    this.#page.title = tab;
    if (!isNew && now - this.#calledAt < AGAIN) return;
    this.#calledAt = now;
    this.#speaker.play("offer");
    this.#vibrate(BUZZ);
    this.#note ??= this.#notify(title, text);
  }

  /** It is taken, missed or no longer wanted: nothing calls any more. */
  end() {
    if (!this.isOn) return;
    this.#page.title = this.#title;
    this.#title = null;
    this.#vibrate([]);
    this.#note?.close();
    this.#note = null;
  }
}
