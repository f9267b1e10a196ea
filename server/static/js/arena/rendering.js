// Who draws this page: a graphics processor, or the computer's own.

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i; // what draws WebGL without one, in all browsers

/** Whether pictures cost next to nothing. WebGL is the one to tell: its renderer has a name. */
export function hasGpu() {
  const context = new OffscreenCanvas(1, 1).getContext("webgl", { failIfMajorPerformanceCaveat: true });
  if (!context) return false;
  const info = context.getExtension("WEBGL_debug_renderer_info"); // where it is not needed any more, there may be none
  const name = context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return !SOFTWARE.test(name);
}
