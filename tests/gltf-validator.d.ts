// What the tests use of gltf-validator, which comes without types.
declare module "gltf-validator" {
  interface Options {
    maxIssues?: number;
    externalResourceFunction?(uri: string): Promise<Uint8Array>;
  }
  interface Report {
    issues: { messages: { code: string; severity: number }[] };
  }
  export function validateBytes(bytes: Uint8Array, options?: Options): Promise<Report>;
}
