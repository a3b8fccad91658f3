// What the page and the tests use of gltf-validator, which comes without types.
declare module "gltf-validator" {
  interface Options {
    /** 0: no limit. */
    maxIssues?: number;
    /** Resolves a URI as the file has it, percent-encoded. */
    externalResourceFunction?(uri: string): Promise<Uint8Array>;
  }
  interface Issues {
    numErrors: number;
    numWarnings: number;
    numInfos: number;
    numHints: number;
    messages: Issue[];
    truncated: boolean;
  }
  interface Issue {
    code: string;
    message: string;
    /** 0: error, 1: warning, 2: info, 3: hint. */
    severity: number;
    /** JSON pointer; in the container of a GLB, there is an offset in bytes instead. */
    pointer?: string;
    offset?: number;
  }
  /** Rejects with a text if the bytes are neither JSON nor GLB. */
  export function validateBytes(bytes: Uint8Array, options?: Options): Promise<{ issues: Issues }>;
}
