// Unpacks the modules and the data that stand in the page, and starts it; it asks no address.
try {
  const packed = atob(document.getElementById("packed").textContent);
  const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const { modules, run } = JSON.parse(await new Response(unpacked).text());
  const addresses = {};
  for (const [name, source] of modules) {
    const linked = source.replace(/(from\s*")\.\/(?:vendor\/)?([\w.]+)"/g, (_, from, other) =>
      `${from}${addresses[other]}"`);
    addresses[name] = URL.createObjectURL(new Blob([linked], { type: "text/javascript" }));
  }
  (await import(addresses["replay.js"])).showReplay(run);
} catch (error) {
  const note = document.getElementById("failure");
  note.textContent = `This browser cannot show the replay: ${error.message}`;
  note.hidden = false;
}
