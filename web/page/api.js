// Requests to the server: JSON in and out, refusals as Problem.

/// A refusal of the server (RFC 9457): `message` is its detail, `pointers` names the bad values.
export class Problem extends Error {
  constructor(status, body) {
    super(body.detail ?? body.title ?? `The server answered ${status}`);
    this.status = status;
    const errors = body.errors ?? [];
    this.pointers = [body.pointer, ...errors.map((error) => error.pointer)].filter(Boolean);
  }
}

async function checked(response) {
  if (response.ok) return response;
  let body = {};
  try {
    body = await response.json();
  } catch {
    body = { title: response.statusText };
  }
  throw new Problem(response.status, body);
}

export async function get_json(path, { signal } = {}) {
  const response = await checked(await fetch(path, { signal, cache: "no-store" }));
  return response.json();
}

export async function send_json(method, path, value = {}) {
  const response = await checked(
    await fetch(path, {
      method,
      headers: { "content-type": "application/json" },
      body: JSON.stringify(value),
    }),
  );
  const text = await response.text();
  return text ? JSON.parse(text) : {};
}

/// A picture as {blob, headers}, or null when the server has nothing new (204).
export async function get_picture(path, { signal } = {}) {
  const response = await checked(await fetch(path, { signal, cache: "no-store" }));
  if (response.status === 204) return null;
  return { blob: await response.blob(), headers: response.headers };
}

/// Sends a file; `on_share` hears how much has left (0..1), which fetch cannot tell.
export function send_file(path, file, on_share) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", path);
    request.setRequestHeader("content-type", "application/octet-stream");
    request.responseType = "json";
    request.upload.onprogress = (event) => on_share(event.loaded / (event.total || 1));
    request.onload = () => {
      if (request.status < 300) resolve(request.response ?? {});
      else reject(new Problem(request.status, request.response ?? {}));
    };
    request.onerror = () => reject(new TypeError("The server did not answer"));
    request.send(file);
  });
}

export const pause_for = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
