// @ts-check
/** Decks of pound-solve in VS Code: starts the language server, shows the picture of a deck, runs it. */

"use strict";

const { execFile } = require("node:child_process");
const fs = require("node:fs/promises");
const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const LANGUAGE = "pound-deck";

/** @type {LanguageClient | undefined} */
let client;
let ready = Promise.resolve();
/** @type {Map<string, Picture>} the open picture of each deck, by the path of the deck */
const pictures = new Map();

/** @param {vscode.ExtensionContext} context */
function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("pound-solve.showPicture", showPicture),
    vscode.commands.registerCommand("pound-solve.runDeck", runDeck),
    vscode.workspace.onDidSaveTextDocument((document) => {
      // which decks include a file is not known here
      if (document.languageId === LANGUAGE) pictures.forEach((picture) => picture.draw());
    }),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (!change.affectsConfiguration("pound-solve")) return;
      restart();
      pictures.forEach((picture) => picture.draw());
    }),
  );
  restart();
}

async function deactivate() {
  await ready;
  await client?.dispose();
}

// ---------------------------------------------------------------- the program

/** The command and the option of records, as set. */
function program() {
  const settings = vscode.workspace.getConfiguration("pound-solve");
  const records = settings.get("records", []).flatMap((folder) => ["--records", folder]);
  return { command: settings.get("command", "pound-solve"), records };
}

/**
 * Run the program to its end, without input.
 * @param {string} command
 * @param {string[]} args
 * @param {{cwd?: string, signal?: AbortSignal}} [options]
 * @returns {Promise<string>} why it failed, in words; empty if it did not
 */
function complaint(command, args, options = {}) {
  return new Promise((resolve) => {
    const child = execFile(command, args, options, (error, _, stderr) => {
      if (typeof error?.code === "string") {
        // it did not start
        resolve(
          `The program ${command} was not found. Install it: pip install "pound-solve[lsp,plot]". ` +
            "If it is in a virtual environment, enter its full path in the setting pound-solve.command.",
        );
      } else resolve(error ? stderr.trim() || error.message : "");
    });
    child.stdin?.end();
  });
}

/** Start the language server, with the settings of now. */
function restart() {
  // one after the other: settings may change while it starts
  ready = ready.then(start).catch((error) => void vscode.window.showErrorMessage(String(error)));
}

async function start() {
  await client?.dispose().catch(() => {}); // the old server may have ended by itself
  client = undefined;
  const { command, records } = program();
  const args = ["lsp", ...records];
  // without input the server ends at once; the client would not say what a server that fails complains of
  const wrong = await complaint(command, args);
  if (wrong) {
    vscode.window.showErrorMessage(wrong, "Open Settings").then((chosen) => {
      if (chosen) vscode.commands.executeCommand("workbench.action.openSettings", "pound-solve.");
    });
    return;
  }
  const help = { documentSelector: [{ language: LANGUAGE }] };
  client = new LanguageClient("pound-solve", { command, args }, help);
  await client.start();
}

// ---------------------------------------------------------------- commands

/**
 * Save a deck, so that the program reads what the user sees.
 * @param {vscode.Uri} [uri] the deck whose button was pressed; of the palette the active editor
 * @returns {Promise<string>} its path; empty if it has none
 */
async function saved(uri) {
  const shown = vscode.window.activeTextEditor?.document;
  const document = uri ? await vscode.workspace.openTextDocument(uri) : shown;
  const hasFile = document?.uri.scheme === "file";
  if (hasFile && (!document.isDirty || (await document.save()))) return document.fileName;
  vscode.window.showWarningMessage("Open a deck and save it in a file first.");
  return "";
}

/** @param {vscode.Uri} [uri] */
async function runDeck(uri) {
  const deck = await saved(uri);
  if (!deck) return;
  const { command, records } = program();
  // a process, not a line of a shell: no name needs quotes
  const run = new vscode.ProcessExecution(command, ["run", deck, ...records], { cwd: path.dirname(deck) });
  const [kind, scope] = [{ type: "pound-solve" }, vscode.TaskScope.Workspace];
  await vscode.tasks.executeTask(new vscode.Task(kind, scope, path.basename(deck), "pound-solve", run));
}

/** @param {vscode.Uri} [uri] */
async function showPicture(uri) {
  const deck = await saved(uri);
  if (!deck) return;
  const open = pictures.get(deck);
  if (open) open.panel.reveal(undefined, true);
  const picture = open ?? new Picture(deck);
  pictures.set(deck, picture);
  await picture.draw();
}

// ---------------------------------------------------------------- the picture

/** The pictures of a deck in a panel beside it. */
class Picture {
  /** @param {string} deck */
  constructor(deck) {
    this.deck = deck;
    this.images = "";
    this.drawing = new AbortController();
    const where = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    const title = `Picture of ${path.basename(deck)}`;
    this.panel = vscode.window.createWebviewPanel("pound-solve.picture", title, where);
    this.panel.webview.html = page("<p>Drawing ...</p>");
    this.panel.onDidDispose(() => {
      this.drawing.abort();
      pictures.delete(deck);
    });
  }

  /** Draw the deck as it is saved; if that is not possible, keep the picture and say why. */
  async draw() {
    this.drawing.abort(); // a later save counts
    this.drawing = new AbortController();
    const { signal } = this.drawing;
    const folder = await fs.mkdtemp(path.join(os.tmpdir(), "pound-solve-"));
    try {
      const { command, records } = program();
      const args = ["plot", path.basename(this.deck), "--out", folder, "--as", "svg", ...records];
      const wrong = await complaint(command, args, { cwd: path.dirname(this.deck), signal });
      const drawn = wrong ? this.images : await imagesIn(folder);
      if (signal.aborted) return;
      this.images = drawn;
      this.panel.webview.html = page(wrong ? mistakes(wrong, drawn) : drawn);
    } finally {
      await fs.rm(folder, { recursive: true, force: true, maxRetries: 3 });
    }
  }
}

/**
 * The SVG files of a folder as images: as such they run no script and load nothing.
 * @param {string} folder
 */
async function imagesIn(folder) {
  const names = (await fs.readdir(folder)).filter((name) => name.endsWith(".svg")).sort();
  const texts = await Promise.all(names.map((name) => fs.readFile(path.join(folder, name), "base64")));
  return texts.map((text) => `<img src="data:image/svg+xml;base64,${text}">`).join("\n");
}

/**
 * What is wrong, and the picture of before.
 * @param {string} wrong
 * @param {string} images
 */
function mistakes(wrong, images) {
  const text = wrong.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const before = images && `<p>This is the picture from before:</p><div class="before">${images}</div>`;
  return `<p>The deck cannot be drawn:</p><pre>${text}</pre>${before}`;
}

/** @param {string} body */
function page(body) {
  const allowed = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${allowed}">
<style>
img { display: block; width: 100%; margin: 0 0 1em; background: white; }
pre { white-space: pre-wrap; color: var(--vscode-errorForeground); }
.before { opacity: 0.5; }
</style>
</head>
<body>${body}</body>
</html>`;
}

module.exports = { activate, deactivate };
