// The panels as transparent HTML over the canvas, one element over each control, for keyboards and screen readers: they can't
// look into a canvas. The program lists the elements (src/app/mirror.rs) and is told what the user does with them.
import { takeFocus } from "./dom.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").MirrorEntry} MirrorEntry */
/** @typedef {Map<Node, ChildNode>} Ends The last element placed in each parent. */

/** Tags by role; everything else is a button. */
const TAGS = { slider: "input", spinbutton: "input", textbox: "input", text: "span", group: "div", section: "div", dialog: "div", img: "div", progressbar: "div" };
/** The role that ARIA requires around another one. */
const LISTS = /** @type {const} */ ({ tab: "tablist", treeitem: "tree", radio: "radiogroup", gridcell: "grid" });
const IN_LIST = Object.values(LISTS).map((role) => `[role=${role}]`).join();
/** Roles of entries that contain others. */
const CONTAINERS = ["group", "section", "dialog"];
/** Roles of list entries that an arrow key chooses, not only reaches. */
const CHOSEN_BY_ARROWS = ["tab", "radio"];
/** Keys that an element handles itself, by its kind. */
const OWN_KEYS = {
  button: /^(Enter| )$/,
  range: /^(Home|End|Page.*)$/,
  spinbutton: /^(?!Escape$)/,
  text: /^(?!(Escape|Enter|ArrowUp|ArrowDown)$)/,
};
/** Keys that change a number by a step, whose size the program knows. */
const STEPS = /** @type {const} */ ({ ArrowUp: "more", ArrowRight: "more", ArrowDown: "less", ArrowLeft: "less" });

/** The mirror of one instance, whose `root` lies over its canvas. */
export class Mirror {
  root = document.createElement("div");
  /** @type {Map<string, HTMLElement>} */
  #elements = new Map();
  #program;
  /** The entry that the program draws as focused. */
  #focused = "";
  /**
   * The entry that was focused here, until the program focuses it as well.
   * @type {string | null}
   */
  #wanted = null;
  /** A list is being shown: an element that leaves with the focus hands it on. */
  #isShowing = false;
  /** The focus follows the program's: to report that back would undo what the program has done since. */
  #isFollowing = false;
  /**
   * What opened the innermost menu.
   * @type {HTMLElement | null}
   */
  #opener = null;

  /** @param {Bindings} program */
  constructor(program) {
    const { root } = this;
    this.#program = program;
    root.id = "mirror";
    root.setAttribute("role", "group");
    root.setAttribute("aria-label", "Viewer");
    for (const type of ["keydown", "keyup"]) root.addEventListener(type, (event) => event instanceof KeyboardEvent && this.#passKey(event));
    root.addEventListener("focusin", () => program.mirror_focus(true));
    root.addEventListener("focusout", ({ relatedTarget }) => {
      if (!this.#isShowing && !(relatedTarget instanceof Node && root.contains(relatedTarget))) program.mirror_focus(false);
    });
  }

  /**
   * Shows the program's list.
   * @param {string} text
   */
  show(text) {
    /** @type {{ focus: string, entries: MirrorEntry[] }} */
    const { focus, entries } = JSON.parse(text);
    const before = this.root.contains(document.activeElement) ? document.activeElement : null;
    this.#isShowing = true;
    const roles = new Map(entries.map(({ id, role }) => [id, role]));
    for (const [id, element] of this.#elements) {
      // Another widget may have taken the id of one that is gone.
      if (roles.get(id) === element.dataset.role) continue;
      element.remove();
      this.#elements.delete(id);
    }
    // Before placing: an empty row in front would take the place of the next one.
    for (const row of this.root.querySelectorAll("[role=row]:empty")) row.remove();
    const hadTree = this.root.querySelector("[role=tree]") !== null;
    const menu = this.#place(entries, focus);
    // Whatever lies under a dialog can't be reached.
    const dialog = this.root.querySelector("[aria-modal=true]");
    for (const element of /** @type {Iterable<HTMLElement>} */ (this.root.children)) element.inert = dialog !== null && !element.contains(dialog);
    if (before instanceof HTMLElement) this.#keepFocus(before, menu, focus, hadTree);
    this.#focused = focus;
    this.#isShowing = false;
    if (before !== null && !this.root.contains(document.activeElement)) this.#program.mirror_focus(false);
  }

  /**
   * Moves on from the program's own focus, so that the canvas doesn't trap the Tab key.
   * @param {KeyboardEvent} event
   */
  leaveCanvas(event) {
    const stops = stopsIn(this.root);
    const isTab = event.key === "Tab" && !event.ctrlKey && !event.altKey && !event.metaKey;
    if (!isTab || stops.length === 0 || this.root.contains(document.activeElement)) return;
    const at = stops.findIndex((stop) => stop === this.#elements.get(this.#focused));
    const next = event.shiftKey ? (at < 0 ? stops.length - 1 : at - 1) : at + 1;
    event.preventDefault();
    event.stopPropagation();
    stops[Math.min(Math.max(next, 0), stops.length - 1)].focus();
  }

  /**
   * Puts the element of each entry into its place; returns the last new group: a menu or dialog that was opened.
   * @param {MirrorEntry[]} entries
   * @param {string} focus
   */
  #place(entries, focus) {
    /** @type {HTMLElement | null} */
    let menu = null;
    /** @type {Ends} */
    const ends = new Map();
    for (const entry of entries) {
      let element = this.#elements.get(entry.id);
      if (element === undefined) {
        element = this.#newElement(entry);
        this.#elements.set(entry.id, element);
        if (entry.role === "group" || entry.role === "dialog") menu = element;
      }
      update(element, entry, entry.id === focus || entry.id === this.#wanted);
      let parent = this.#elements.get(entry.in ?? "") ?? this.root;
      const list = LISTS[/** @type {keyof typeof LISTS} */ (entry.role)];
      if (list !== undefined) parent = listIn(parent, list, ends, entry.list);
      if (entry.row !== undefined) parent = listIn(parent, "row", ends, String(entry.row));
      const next = nextIn(parent, ends);
      if (next !== element) parent.insertBefore(element, next);
      ends.set(parent, element);
    }
    for (const list of this.root.querySelectorAll(IN_LIST)) chooseStop(list);
    return menu;
  }

  /** @param {MirrorEntry} entry */
  #newElement({ id, role, focusable }) {
    const element = document.createElement(TAGS[/** @type {keyof typeof TAGS} */ (role)] ?? "button");
    if (element instanceof HTMLButtonElement) element.type = "button";
    if (element instanceof HTMLInputElement) {
      element.type = role === "slider" ? "range" : "text";
      // The browser's own field for numbers knows one decimal separator, which depends on the language.
      if (role === "spinbutton") [element.role, element.inputMode] = [role, "decimal"];
    } else if (role !== "button" && role !== "combobox" && role !== "text") element.setAttribute("role", role === "section" ? "group" : role);
    if (role === "dialog") element.ariaModal = "true";
    if (role === "img" && focusable) element.tabIndex = 0;
    [element.dataset.id, element.dataset.role] = [id, role];
    // What is in it answers for itself.
    if (CONTAINERS.includes(role)) return element;
    element.addEventListener("focus", () => {
      if (this.#isFollowing) return;
      this.#wanted = id;
      this.#program.mirror_act(id, "focus");
    });
    element.addEventListener("click", () => {
      // What is in a menu leaves with it.
      if (menuAround(element) === null) this.#opener = element;
      this.#program.mirror_act(id, "click");
    });
    if (element instanceof HTMLInputElement) {
      const isNumber = role === "spinbutton";
      if (isNumber) {
        element.addEventListener("input", () => void (element.dataset.typing = ""));
        for (const type of ["change", "blur"]) element.addEventListener(type, () => void delete element.dataset.typing);
      }
      element.addEventListener(isNumber ? "change" : "input", () => {
        // The program focuses its field again for a text.
        if (role === "textbox") this.#wanted = id;
        const value = isNumber ? numberIn(element.value) : element.type === "range" ? element.valueAsNumber : element.value;
        if (Number.isNaN(value)) element.value = element.ariaValueNow ?? "";
        else this.#program.mirror_act(id, "set", value);
      });
    }
    return element;
  }

  /**
   * Moves the focus to where the user expects it: into a menu that opens, unless the user has gone on meanwhile, in a chooser to
   * what is chosen, to where the program has its own, back to what opened a menu that closes, or else to what is nearest to where
   * it was.
   * @param {HTMLElement} before What had the focus.
   * @param {HTMLElement | null} menu What has just opened.
   * @param {string} focus
   * @param {boolean} hadTree Whether there was a tree before.
   */
  #keepFocus(before, menu, focus, hadTree) {
    if (this.#wanted === focus) this.#wanted = null;
    const hasGoneOn = menu?.dataset.role === "group" && before.isConnected && before !== this.#opener && menuAround(before) === null;
    const stops = menu === null || hasGoneOn ? [] : stopsIn(menu);
    const isChooser = this.#opener?.dataset.role === "combobox";
    const first = (isChooser ? stops.find(({ ariaPressed }) => ariaPressed === "true") : undefined) ?? stops[0];
    const hasMoved = !before.isConnected || (this.#wanted === null && focus !== this.#focused);
    const next = hasMoved ? (this.#elements.get(focus) ?? before) : before;
    /** What "Go to" leads to. @type {HTMLElement | null} */
    const selected = hadTree ? null : this.root.querySelector("[role=treeitem][aria-selected=true]");
    const fallback = this.#opener?.isConnected ? this.#opener : (selected ?? rowOfTreeAt(this.root, before) ?? nearest(stopsIn(this.root), before));
    const target = first ?? (next.isConnected ? next : fallback);
    this.#isFollowing = target?.dataset.id === focus;
    if (target !== document.activeElement) takeFocus(target);
    if (this.#isFollowing) this.#wanted = null;
    this.#isFollowing = false;
  }

  /** @param {KeyboardEvent} event */
  #passKey(event) {
    const { key, code, target, altKey, ctrlKey, shiftKey, metaKey } = event;
    const { type = "", role = null } = target instanceof HTMLInputElement || target instanceof HTMLButtonElement ? target : {};
    const kind = role === "spinbutton" ? role : type;
    const isCommand = ctrlKey || metaKey;
    // What is being typed isn't the program's yet: the field shows its number again.
    if (kind === "spinbutton" && key === "Escape" && target instanceof HTMLInputElement && target.dataset.typing !== undefined) {
      delete target.dataset.typing;
      target.value = target.ariaValueNow ?? "";
    }
    const next = isCommand ? undefined : neighbourOf(target, key);
    if (next !== undefined) {
      if (event.type === "keydown") {
        next?.focus();
        // In a menu, arrow keys also lead into and out of groups of radio buttons.
        const isInGroup = next !== null && next.closest(IN_LIST) === /** @type {HTMLElement} */ (target).closest(IN_LIST);
        if (isInGroup && CHOSEN_BY_ARROWS.includes(next.dataset.role ?? "")) next.click();
      }
      event.preventDefault();
      return;
    }
    const way = kind === "range" || kind === "spinbutton" ? STEPS[/** @type {keyof typeof STEPS} */ (key)] : undefined;
    if (way !== undefined && !isCommand) {
      if (event.type === "keydown") this.#program.mirror_act(/** @type {HTMLElement} */ (target).dataset.id ?? "", way);
      event.preventDefault();
      return;
    }
    // The browser does it in its field, and then sets the program's.
    if (kind === "text" && isCommand && /^([yz]|Backspace|Delete)$/i.test(key)) return;
    if (kind === "spinbutton" && isCommand && /^[yz]$/i.test(key)) {
      // The browser takes back what is being typed, the program what was entered: its own field would take back the text alone.
      const { id, typing } = /** @type {HTMLElement} */ (target).dataset;
      if (typing !== undefined) return;
      if (event.type === "keydown") this.#program.mirror_act(id ?? "", "blur");
    }
    if (key === "Tab" || (!isCommand && OWN_KEYS[/** @type {keyof typeof OWN_KEYS} */ (kind)]?.test(key))) return;
    this.#program.mirror_key(key, code, event.type === "keydown", altKey, ctrlKey, shiftKey, metaKey);
    // The browser's own commands stay, also those of function keys.
    if (!(isCommand || altKey || /^F([2-9]|1.)$/.test(key)) || /^[ozsy]$/i.test(key)) event.preventDefault();
  }
}

/**
 * @param {HTMLElement} element
 * @param {MirrorEntry} entry
 * @param {boolean} isFocused Whether the program has focused the entry, or is about to.
 */
function update(element, entry, isFocused) {
  const { role, name, value, now, min, max, checked, rect } = entry;
  const isPicked = role === "tab" || role === "treeitem" || role === "gridcell";
  const state = isPicked ? "aria-selected" : role === "button" ? "aria-pressed" : "aria-checked";
  const hasRange = role === "progressbar" || role === "spinbutton";
  const attributes = {
    "aria-label": role === "text" ? undefined : role === "combobox" && value !== undefined ? `${name ?? ""} ${value}`.trim() : name,
    "aria-description": entry.description,
    "aria-valuetext": role === "slider" || role === "spinbutton" ? value : undefined,
    "aria-valuenow": hasRange ? now : undefined,
    "aria-valuemin": hasRange ? min : undefined,
    "aria-valuemax": hasRange ? max : undefined,
    "aria-expanded": entry.expanded,
    "aria-disabled": entry.disabled,
    "aria-level": entry.level,
    "aria-posinset": entry.at,
    "aria-setsize": entry.of,
    [state]: checked,
  };
  for (const [attribute, text] of Object.entries(attributes)) {
    if (text === undefined) element.removeAttribute(attribute);
    else if (element.getAttribute(attribute) !== String(text)) element.setAttribute(attribute, String(text));
  }
  if (role === "text" && element.textContent !== name) element.textContent = name ?? "";
  if (element instanceof HTMLInputElement) updateInput(element, entry, isFocused);
  for (const [index, side] of ["left", "top", "width", "height"].entries()) if (rect !== undefined) element.style.setProperty(side, `${rect[index]}px`);
}

/**
 * @param {HTMLInputElement} input
 * @param {MirrorEntry} entry
 * @param {boolean} isFocused
 */
function updateInput(input, { role, value, now, min, max }, isFocused) {
  const isText = role === "textbox";
  if (role === "slider") [input.min, input.max, input.step] = [String(min ?? ""), String(max ?? ""), "any"];
  const shown = String((isText ? value : now) ?? "");
  // The program doesn't know yet what is being typed. A key that accepts or cancels a text takes away its focus, not the element's.
  const isTyping = input === document.activeElement && (isText ? isFocused : input.dataset.typing !== undefined);
  if (input.value !== shown && !isTyping) input.value = shown;
}

/**
 * Reads a number as the panels do (`read_number` in src/ui/widgets/controls/numbers.rs): decimals may follow a comma. NaN for anything else.
 * @param {string} text
 */
function numberIn(text) {
  const trimmed = text.trim().replace("−", "-");
  return trimmed === "" ? NaN : Number(trimmed.includes(".") ? trimmed : trimmed.replace(",", "."));
}

/** @type {(element: HTMLElement) => number[]} */
const centreOf = ({ style: { left, top, width, height } }) => [parseFloat(left) + parseFloat(width) / 2, parseFloat(top) + parseFloat(height) / 2];

/**
 * Returns the current row of a tree above or below an element that is gone, as a node's details are.
 * @param {HTMLElement} root
 * @param {HTMLElement} gone
 * @returns {HTMLElement | null}
 */
function rowOfTreeAt(root, gone) {
  /** @type {HTMLElement | null} */
  const row = root.querySelector('[role=treeitem][tabindex="0"]');
  const [x] = centreOf(gone);
  const start = parseFloat(row?.style.left ?? "");
  return row !== null && x > start && x < start + parseFloat(row.style.width) ? row : null;
}

/**
 * Returns the element in whose direction the eye would go from one that is gone; the viewport only if there is nothing else. Only a
 * field leads to a field: keys that were meant for something else would change a number.
 * @param {HTMLElement[]} stops
 * @param {HTMLElement} gone
 */
function nearest(stops, gone) {
  const [x, y] = centreOf(gone);
  /** @type {(element: HTMLElement) => number} */
  const distance = (element) => {
    const [otherX, otherY] = centreOf(element);
    return element.dataset.role === "img" ? Infinity : Math.hypot(otherX - x, otherY - y);
  };
  const others = gone instanceof HTMLInputElement ? [] : stops.filter((stop) => !(stop instanceof HTMLInputElement));
  /** @type {HTMLElement | undefined} */
  let best;
  for (const stop of others.length > 0 ? others : stops) if (best === undefined || distance(stop) < distance(best)) best = stop;
  return best;
}

/**
 * Returns what follows the last element placed in a parent.
 * @param {Node} parent
 * @param {Ends} ends
 * @returns {Node | null}
 */
const nextIn = (parent, ends) => ends.get(parent)?.nextSibling ?? (ends.has(parent) ? null : parent.firstChild);

/**
 * Returns the list of a role at the place where the next element goes.
 * @param {HTMLElement} parent
 * @param {string} role
 * @param {Ends} ends
 * @param {string} [key] Distinguishes adjacent lists of the same role: a list's name.
 */
function listIn(parent, role, ends, key = "") {
  /** @param {Node | null | undefined} node */
  const asList = (node) => (node instanceof HTMLElement && node.getAttribute("role") === role && node.dataset.key === key ? node : null);
  const last = asList(ends.get(parent));
  if (last !== null) return last;
  const next = nextIn(parent, ends);
  const list = asList(next) ?? document.createElement("div");
  list.setAttribute("role", role);
  list.dataset.key = key;
  if (role !== "row") list.setAttribute("aria-label", key);
  if (list !== next) parent.insertBefore(list, next);
  ends.set(parent, list);
  return list;
}

/**
 * Makes one element of a list a stop of the Tab key, the selected one; the arrow keys lead to the others. Removes an empty list.
 * @param {Element} list
 */
function chooseStop(list) {
  const items = itemsOf(list);
  const stop = items.find((item) => item.ariaSelected === "true" || item.ariaChecked === "true") ?? items[0];
  for (const item of items) item.tabIndex = item === stop ? 0 : -1;
  if (stop === undefined) list.remove();
}

/**
 * Returns the element that an arrow key leads to in a list, or Home and End in a menu or among tabs, null at its end; undefined for other keys
 * and outside lists. In a tree, left and right are left to the rows, which they collapse and expand.
 * @param {EventTarget | null} target
 * @param {string} key
 */
function neighbourOf(target, key) {
  const menu = target instanceof HTMLElement ? menuAround(target) : null;
  const list = target instanceof HTMLElement ? target.closest(IN_LIST) : null;
  const step = { ArrowUp: -1, ArrowLeft: -1, ArrowDown: 1, ArrowRight: 1 }[key];
  const end = { Home: 0, End: -1 }[key];
  if (menu !== null && end !== undefined && !(target instanceof HTMLInputElement)) return stopsIn(menu).at(end) ?? null;
  if (!(target instanceof HTMLElement) || list === null) return undefined;
  const items = itemsOf(list);
  // Elsewhere these keys are the program's.
  if (end !== undefined && list.role === "tablist") return items.at(end) ?? null;
  if (step === undefined) return undefined;
  const [role, isSideways] = [list.getAttribute("role"), key === "ArrowLeft" || key === "ArrowRight"];
  if (role === "tree" && isSideways) return undefined;
  if (role === "grid" && !isSideways) {
    const { parentElement: row } = target;
    // The controls of an open row lie between two grids.
    const rows = [...(list.parentElement?.querySelectorAll("[role=row]") ?? [])];
    const next = row === null ? undefined : rows[rows.indexOf(row) + step];
    const cells = /** @type {HTMLElement[]} */ ([...(next?.children ?? [])]);
    // A heading has one cell.
    return cells[Math.min([...(row?.children ?? [])].indexOf(target), cells.length - 1)] ?? null;
  }
  return items[items.indexOf(target) + step] ?? null;
}

/** @param {Element} list */
const itemsOf = (list) => /** @type {HTMLElement[]} */ ([...list.querySelectorAll("[data-id]")]);

/** @type {(element: HTMLElement) => HTMLElement | null} */
const menuAround = (element) => element.closest("[data-role=group]");

/** @param {HTMLElement} parent */
const stopsIn = (parent) => [.../** @type {NodeListOf<HTMLElement>} */ (parent.querySelectorAll("button, input, [tabindex]"))].filter((stop) => stop.tabIndex >= 0 && stop.closest("[inert]") === null);
