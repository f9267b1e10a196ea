// The one place that makes the browser sound. It is silent until the visitor's first touch or key, and where there is no audio.

import { noiseSamples, schedule } from "./sound.js";

const NOISE = 1; // s of noise that is made once; a voice of noise is never longer
const FADE = 0.02; // s in which the volume changes, so that it does not click

/**
 * Put a sound into an audio graph.
 * @param {BaseAudioContext} context
 * @param {AudioNode} output
 * @param {AudioBuffer} noise of at least the length of the sound's voices
 * @param {string} name of a sound in sound.js
 */
export function sound(context, output, noise, name) {
  for (const voice of schedule(name, context.currentTime)) {
    const source = voice.pitch ? context.createOscillator() : context.createBufferSource();
    if (voice.pitch) {
      source.type = voice.wave;
      follow(source.frequency, voice.pitch);
    } else {
      source.buffer = noise;
    }
    const loudness = context.createGain();
    follow(loudness.gain, voice.level);
    let end = source;
    if (voice.below) {
      const filter = context.createBiquadFilter();
      follow(filter.frequency, voice.below);
      end = end.connect(filter);
    }
    end.connect(loudness).connect(output);
    source.start(voice.start);
    source.stop(voice.stop);
  }
}

function follow(parameter, [[start, value], ...rest]) {
  parameter.setValueAtTime(value, start);
  for (const [moment, next] of rest) parameter.exponentialRampToValueAtTime(next, moment);
}

/** Noise for `sound`. */
export function makeNoise(context) {
  const buffer = context.createBuffer(1, NOISE * context.sampleRate, context.sampleRate);
  buffer.copyToChannel(noiseSamples(buffer.length), 0);
  return buffer;
}

/** Plays the sounds of sound.js as loud as the visitor's preferences say. */
export class Speaker {
  #preferences;
  #Context;
  #context = null;
  #master = null;
  #noise = null;
  #timer = null;
  #repeated = null;

  /**
   * @param {import("./preferences_store.js").Preferences} preferences
   * @param {typeof AudioContext} [Context] undefined where the browser has no audio
   */
  constructor(preferences, Context = globalThis.AudioContext) {
    this.#preferences = preferences;
    this.#Context = Context;
    preferences.watch(() => this.#setVolume());
  }

  /** Wake up at the first touch or key in `target`, which browsers ask for; again when a phone has taken the sound away. */
  listen(target) {
    const wake = () => this.wake();
    for (const event of ["keydown", "pointerup"]) target.addEventListener(event, wake, true);
    target.addEventListener("pointerdown", ({ pointerType }) => pointerType === "mouse" && wake(), true); // a finger's press does not count yet
  }

  /** Let there be sound, in answer to something that the visitor has done. */
  wake() {
    if (!this.#context) this.#open();
    if (this.#context?.state !== "running") this.#context?.resume().catch(() => {}); // the next touch may have more success
  }

  /** Play a sound now, or never: while there is no audio yet or it is muted, it is lost. */
  play(name) {
    if (this.#context?.state !== "running" || !this.#preferences.get("sound")) return;
    sound(this.#context, this.#master, this.#noise, name);
  }

  /** Play a sound now and every `seconds` until `quiet`. To repeat what is repeated already changes nothing. */
  repeat(name, seconds) {
    if (this.#repeated === name) return;
    this.quiet();
    this.#repeated = name;
    this.play(name);
    this.#timer = setInterval(() => this.play(name), seconds * 1000);
  }

  /** Nothing is repeated any more. */
  quiet() {
    clearInterval(this.#timer);
    this.#repeated = null;
  }

  #open() {
    if (!this.#Context) return;
    try {
      this.#context = new this.#Context();
    } catch {
      this.#Context = undefined; // no device, or too many tabs with sound: it would not help to ask again
      return;
    }
    const compressor = this.#context.createDynamicsCompressor(); // many sounds at once stay below the limit
    compressor.connect(this.#context.destination);
    this.#master = this.#context.createGain();
    this.#master.connect(compressor);
    this.#noise = makeNoise(this.#context);
    this.#setVolume();
  }

  #setVolume() {
    if (!this.#context) return;
    const volume = this.#preferences.get("sound") ? this.#preferences.get("volume") ** 2 : 0; // squared: as loudness is heard
    this.#master.gain.setTargetAtTime(volume, this.#context.currentTime, FADE);
  }
}
