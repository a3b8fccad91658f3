// ESLint finds what types do not: dead code, sloppy equality, and the like.
import js from "@eslint/js";
import { builtinRules } from "eslint/use-at-your-own-risk";

/** @typedef {import("eslint").Rule.RuleContext} RuleContext */

const maxLines = /** @type {import("eslint").Rule.RuleModule} */ (builtinRules.get("max-lines-per-function"));

/** @type {(node: any) => boolean} */
const isSuite = ({ parent }) => parent.type === "CallExpression" && parent.callee.name === "describe";

/**
 * The rule of the same name, except that a suite may hold any number of tests.
 * @type {import("eslint").Rule.RuleModule}
 */
const maxLinesOutsideSuites = {
  ...maxLines,
  create: (/** @type {RuleContext} */ context) => {
    const report = (/** @type {any} */ problem) => isSuite(problem.node) || context.report(problem);
    return maxLines.create(Object.create(context, { report: { value: report } }));
  },
};

export default [
  { ignores: ["dist/", "target/", "node_modules/", "tests/browser/out/"] },
  js.configs.recommended,
  {
    languageOptions: { ecmaVersion: "latest", sourceType: "module" },
    plugins: { gaitway: { rules: { "max-lines-per-function": maxLinesOutsideSuites } } },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      // TypeScript knows every name.
      "no-undef": "off",
      "array-callback-return": "error",
      eqeqeq: "error",
      "gaitway/max-lines-per-function": ["error", { max: 60, skipBlankLines: true, skipComments: true }],
      "max-depth": ["error", 4],
      "no-constructor-return": "error",
      "no-self-compare": "error",
      "no-template-curly-in-string": "error",
      "no-unmodified-loop-condition": "error",
      "no-unreachable-loop": "error",
      "no-use-before-define": ["error", { functions: false, variables: false }],
      "no-useless-rename": "error",
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-const": "error",
      "prefer-template": "error",
      radix: "error",
    },
  },
];
