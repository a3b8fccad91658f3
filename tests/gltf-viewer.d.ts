// Types for the part of @khronosgroup/gltf-viewer that the tests use; the package has none.
declare module "@khronosgroup/gltf-viewer/dist/gltf-viewer.module.js" {
  type Gltf = { scene?: number };
  type Environment = { readonly isEnvironment: never };
  export class GltfState {
    static ToneMaps: { KHR_PBR_NEUTRAL: string };
    gltf: Gltf;
    environment: Environment;
    sceneIndex: number;
    animationIndices: number[];
    renderingParameters: {
      clearColor: number[];
      environmentRotation: number;
      renderEnvironmentMap: boolean;
      toneMap: string;
      useIBL: boolean;
      usePunctual: boolean;
    };
    userCamera: {
      perspective: { aspectRatio: number; znear: number; zfar: number };
      transform: Float32Array;
      setVerticalFoV(radians: number): void;
    };
  }
  export class GltfView {
    constructor(context: WebGL2RenderingContext);
    createState(): GltfState;
    renderFrame(state: GltfState, width: number, height: number): void;
  }
  export class ResourceLoader {
    constructor(view: GltfView, libraries: string);
    loadEnvironment(url: string, tables: { lut_sheen_E_file: string }): Promise<Environment>;
    loadGltf(url: string): Promise<Gltf>;
  }
}
