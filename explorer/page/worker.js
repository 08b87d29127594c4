// The core in its own thread: a request in, the text and numbers of the answer out.

let module;
let core;

onmessage = async ({ data }) => {
  if (data.module) module = data.module;
  // After a panic, the next request gets a new instance.
  core ??= await instance(module);
  if (!data.request) return;
  const [text, numbers] = answer(data.request);
  postMessage({ text, numbers }, [numbers.buffer]);
};

async function instance(compiled) {
  const imports = {};
  // The linear program wants to measure its time; a clock that stands still is enough.
  for (const { module: from, name } of WebAssembly.Module.imports(compiled)) {
    (imports[from] ??= {})[name] = () => 0;
  }
  return (await WebAssembly.instantiate(compiled, imports)).exports;
}

function answer(request) {
  const bytes = new TextEncoder().encode(request);
  const start = core.input(bytes.length);
  new Uint8Array(core.memory.buffer, start, bytes.length).set(bytes);
  try {
    core.run();
  } catch {
    const why = read(core.panic_text(), core.panic_bytes()) || "it ran out of memory";
    core = undefined;
    const message = `the core failed: ${why}; please report this with the scenario`;
    return [JSON.stringify({ error: { message } }), new Float64Array()];
  }
  const numbers = new Float64Array(core.memory.buffer, core.numbers(), core.numbers_count());
  return [read(core.text(), core.text_bytes()), numbers.slice()];
}

function read(start, length) {
  return new TextDecoder().decode(new Uint8Array(core.memory.buffer, start, length));
}
