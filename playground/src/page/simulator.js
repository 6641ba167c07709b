// The simulator's module as functions of texts: in a worker of the page, and in node.

/** What the module does; `module` is compiled. */
async function simulator(module) {
  const { exports } = await WebAssembly.instantiate(module, {});
  const { memory } = exports;
  const put = (bytes) => {
    const at = exports.room(bytes.length) >>> 0;
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
  };
  const taken = (at) => new TextDecoder().decode(new Uint8Array(memory.buffer, at >>> 0, exports.length()));
  const coded = (text) => new TextEncoder().encode(text);
  return {
    /** Takes a file that scenarios may name. */
    hand(name, bytes) {
      const own = coded(name);
      const all = new Uint8Array(own.length + bytes.length);
      all.set(own);
      all.set(bytes, own.length);
      put(all);
      exports.hand(own.length);
    },
    /** Flies a scenario: whether it was flown, and what is to be said of it. */
    run(text) {
      put(coded(text));
      const isFlown = exports.run() !== 0;
      return { isFlown, notes: taken(exports.said()) };
    },
    trace: () => taken(exports.text()),
    scenes: () => JSON.parse(taken(exports.scenes())),
  };
}
