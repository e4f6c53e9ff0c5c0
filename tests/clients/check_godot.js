// SPDX-License-Identifier: GPL-3.0-or-later
// Parses GDScript files: node check_godot.js FILE.gd... Prints a line for each place that is no GDScript; exit status 1: there is one.
import fs from 'node:fs';
import Parser from 'tree-sitter';
import gdscript from 'tree-sitter-gdscript';

const parser = new Parser();
parser.setLanguage(gdscript);
let good = true;
for (const file of process.argv.slice(2)) {
    const root = parser.parse(fs.readFileSync(file, 'utf8')).rootNode;
    const visit = (node) => {
        if (node.type === 'ERROR' || node.isMissing) console.log(`${file}:${node.startPosition.row + 1}: ${node.text.split('\n')[0]}`);
        else if (node.hasError) node.children.forEach(visit);
    };
    visit(root);
    good &&= !root.hasError;
}
process.exit(good ? 0 : 1);
