// Maps a place in a glTF file to one that belongs to a node. The app finds the nodes that use a mesh, a skin or a material,
// but knows neither accessors nor channel indices.

/**
 * The members by which objects refer to those of each list.
 * @type {Record<string, Record<string, RegExp>>}
 */
const REFERENCES = {
  accessors: { meshes: /^(indices|[A-Z_][A-Z_0-9]*)$/, skins: /^inverseBindMatrices$/, animations: /^(input|output)$/ },
  bufferViews: { accessors: /^bufferView$/, images: /^bufferView$/ },
  cameras: { nodes: /^camera$/ },
  images: { textures: /^source$/ },
  samplers: { textures: /^sampler$/ },
  textures: { materials: /^index$/ },
};

/**
 * Returns the JSON pointer of the node, mesh, skin or material that uses what a pointer leads to. Without one, it ends at
 * what is found on the way. The document may be anything.
 * @param {any} document
 * @param {string} pointer
 * @returns {string}
 */
export function userOf(document, pointer) {
  try {
    return find(document, pointer);
  } catch {
    return pointer;
  }
}

/**
 * @param {any} document
 * @param {string} pointer
 * @returns {string}
 */
function find(document, pointer) {
  const [, list, index, member, at] = pointer.split("/");
  if (list === "animations") {
    const { channels } = document.animations[index];
    const used = member === "samplers" ? channels.find((/** @type {any} */ { sampler }) => sampler === Number(at)) : channels[member === "channels" ? at : 0];
    const { node, extensions } = used.target;
    return node === undefined ? find(document, extensions.KHR_animation_pointer.pointer) : `/nodes/${node}`;
  }
  for (const [users, members] of Object.entries(REFERENCES[list] ?? {})) {
    const found = reference(document[users], members, Number(index), `/${users}`);
    if (found !== undefined) return find(document, found);
  }
  return pointer;
}

/**
 * Returns the pointer of the first member with a matching name and this value.
 * @param {unknown} value
 * @param {RegExp} members
 * @param {number} index
 * @param {string} path
 * @returns {string | undefined}
 */
function reference(value, members, index, path) {
  if (typeof value !== "object" || value === null) return undefined;
  for (const [name, inner] of Object.entries(value)) {
    const place = `${path}/${name}`;
    const found = inner === index && members.test(name) ? place : reference(inner, members, index, place);
    if (found !== undefined) return found;
  }
  return undefined;
}
