// Where three.js departs from glTF 2.0, so that its numbers are no reference: each entry cites the sentence. An entry that
// is no longer needed fails the test.

/** `{file, meshes?, nodes?, clip?, because}`: the file's name; node numbers whose mesh or own matrix is not compared; without `clip`, in all. */
export const exceptions = [];
