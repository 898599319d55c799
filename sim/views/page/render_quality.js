// How finely is drawn: less where frames take too long, fully where nothing moves.

import * as THREE from "./vendor/three.module.min.js";

const LEVELS = [
  { ratio: 2, shadow: 2048, every: 1 },
  { ratio: 1, shadow: 1024, every: 1 },
  { ratio: 0.75, shadow: 512, every: 2 },
  { ratio: 0.6, shadow: 512, every: 3 },
  { ratio: 0.45, shadow: 512, every: 4 },
]; // pixel ratio, width of the shadow map, frames from one shadow to the next
const SLOW = 1 / 24; // frames that take longer lower the quality [s]
const QUICK = 1 / 50;
const FINE = { hardware: 2, software: 1.5 }; // least pixel ratios of what stands still
const PATIENCE = 10; // frames before it is changed, and ten times as many before it is raised

export class RenderQuality {
  constructor(renderer, light, { software }) {
    this.renderer = renderer;
    this.light = light;
    this.software = software;
    this.level = software ? 2 : 0;
    this.mean = 0;
    this.frames = 0;
    this.shown = null;
    this.drawn = 0;
    light.castShadow = true;
    renderer.shadowMap.autoUpdate = false;
  }

  // Is told how long a frame took while things move [s].
  feel(seconds) {
    if (seconds > 0.5) return; // the page was hidden
    this.mean = this.mean ? 0.85 * this.mean + 0.15 * seconds : seconds;
    this.frames++;
    if (this.mean > SLOW && this.frames > PATIENCE) this.#change(1);
    else if (this.mean < QUICK && this.frames > 10 * PATIENCE) this.#change(-1);
  }

  #change(by) {
    this.level = Math.min(LEVELS.length - 1, Math.max(this.software ? 1 : 0, this.level + by));
    this.frames = 0;
    this.mean = 0;
  }

  // Prepares the renderer for the next frame: of what moves, or of what stands still.
  apply(still) {
    const here = globalThis.devicePixelRatio;
    const level = LEVELS[still ? (this.software ? 1 : 0) : this.level];
    const fine = this.software ? FINE.software : FINE.hardware;
    const ratio = still ? Math.max(here, fine) : Math.min(here, level.ratio);
    const { shadowMap } = this.renderer;
    this.drawn++;
    shadowMap.needsUpdate = still || this.drawn % level.every === 0;
    const key = `${ratio} ${level.shadow}`;
    if (key === this.shown) return;
    this.shown = key;
    this.renderer.setPixelRatio(ratio);
    const { shadow } = this.light;
    shadow.mapSize.set(level.shadow, level.shadow);
    shadow.map?.dispose();
    shadow.map = null;
    shadowMap.needsUpdate = true;
  }
}

// Whether what was drawn is done. Who draws on before that has the script wait for it.
export class DrawingFence {
  constructor(renderer) {
    this.gl = renderer.getContext();
    this.sync = null;
  }

  // Begins to wait for all that was drawn so far.
  raise() {
    if (this.sync) this.gl.deleteSync(this.sync);
    this.sync = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
  }

  get isDown() {
    const { gl, sync } = this;
    if (!sync || gl.isContextLost()) return true;
    return gl.getSyncParameter(sync, gl.SYNC_STATUS) === gl.SIGNALED;
  }
}

// A renderer, and whether it draws in software; it takes one context, since another one takes time.
export function newRenderer() {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2", { alpha: true, antialias: false });
  const software = context !== null && isSoftware(context);
  const options = software ? { canvas, context } : { antialias: true, powerPreference: "high-performance" };
  if (context && !software) context.getExtension("WEBGL_lose_context")?.loseContext();
  const renderer = new THREE.WebGLRenderer(options);
  // What is asked of the drawing process in the midst of a frame has the script wait for all of it.
  renderer.debug.checkShaderErrors = false;
  renderer.extensions.has("EXT_texture_filter_anisotropic");
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFShadowMap;
  return { renderer, software };
}

function isSoftware(context) {
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const name = names ? context.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
