/**
 * The page of a live scene in an output cell: an iframe, and what carries its words over the widget's channel.
 * docs/view_protocol.md, "In a notebook".
 */

/** The bytes of a buffer, which notebooks hand over as a view or as what it is a view of. */
function bytesOf(buffer) {
  if (buffer instanceof ArrayBuffer) return buffer;
  return buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.byteLength);
}

function render({ model, el }) {
  const page = Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("");
  const frame = document.createElement("iframe");
  frame.title = model.get("title");
  frame.setAttribute("sandbox", "allow-scripts allow-downloads");
  frame.style.cssText = `display: block; width: 100%; height: ${model.get("height")}px; border: 0`;
  let port = null;

  const say = (kind, more = {}, buffers = []) => model.send({ page, kind, ...more }, undefined, buffers);
  const hear = (message, buffers) => {
    if (message.page !== page) return;
    if (message.kind === "html") frame.srcdoc = new TextDecoder().decode(bytesOf(buffers[0]));
    else if (message.kind === "text") port?.postMessage(message.text);
    else if (message.kind === "end") port?.postMessage({ end: message.text });
    else port?.postMessage(bytesOf(buffers[0]));
  };
  // A page that is loaded, also again after its cell was moved, asks for its port.
  const connect = (event) => {
    if (event.source !== frame.contentWindow || event.data !== "resilin: open") return;
    const channel = new MessageChannel();
    port?.close();
    port = channel.port1;
    port.onmessage = ({ data }) => (typeof data === "string" ? say("text", { text: data }) : say("bytes", {}, [data]));
    frame.contentWindow.postMessage("resilin: port", "*", [channel.port2]);
    say("open");
  };

  model.on("msg:custom", hear);
  window.addEventListener("message", connect);
  el.append(frame);
  say("html");
  return () => {
    model.off("msg:custom", hear);
    window.removeEventListener("message", connect);
    port?.close();
    say("close");
  };
}

export default { render };
