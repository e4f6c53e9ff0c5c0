// SPDX-License-Identifier: GPL-3.0-or-later
// Runs GDScript without Godot, as far as drivers need it: the text becomes JavaScript, and the types below compute as Godot's do, in double precision.
import fs from 'node:fs';
import * as THREE from 'three';
import Parser from 'tree-sitter';
import gdscript from 'tree-sitter-gdscript';

const parser = new Parser();
parser.setLanguage(gdscript);

/// Where a text is no GDScript: [{row, text}, ...].
export function mistakes(text) {
    const found = [];
    const visit = (node) => {
        if (node.type === 'ERROR' || node.isMissing) found.push({ row: node.startPosition.row + 1, text: node.text.split('\n')[0] });
        else if (node.hasError) node.children.forEach(visit);
    };
    visit(parser.parse(text).rootNode);
    return found;
}

// ---- types -----------------------------------------------------------------------------------------------------------

class Vector {
    constructor(...numbers) { this.n = numbers; }
    get x() { return this.n[0]; }
    get y() { return this.n[1]; }
    get z() { return this.n[2]; }
    get w() { return this.n[3]; }
    dot(b) { return this.n.reduce((sum, v, i) => sum + v * b.n[i], 0); }
    length() { return Math.sqrt(this.dot(this)); }
    normalized() { return this.map((v) => v / this.length()); }
    map(f) { return new this.constructor(...this.n.map(f)); }
}
class Vector3 extends Vector {
    static ZERO = new Vector3(0, 0, 0);
    static RIGHT = new Vector3(1, 0, 0);
    static UP = new Vector3(0, 1, 0);
    cross(b) { return new Vector3(this.y * b.z - this.z * b.y, this.z * b.x - this.x * b.z, this.x * b.y - this.y * b.x); }
}
class Vector4 extends Vector {
    static ZERO = new Vector4(0, 0, 0, 0);
}
class Quaternion extends Vector {
    static IDENTITY = new Quaternion(0, 0, 0, 1);
    /// x, y, z, w, or a unit axis and an angle.
    constructor(...given) {
        super(...(given.length === 4 ? given : [...given[0].n.map((v) => v * Math.sin(given[1] / 2)), Math.cos(given[1] / 2)]));
    }
}
class Basis {
    static get IDENTITY() { return new Basis(); }
    /// Its columns, a quaternion, or nothing.
    constructor(...given) {
        if (given.length === 3) this.columns = given;
        else {
            const m = new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion(...(given[0] ?? Quaternion.IDENTITY).n)).elements;
            this.columns = [0, 4, 8].map((c) => new Vector3(m[c], m[c + 1], m[c + 2]));
        }
    }
    get x() { return this.columns[0]; }
    get y() { return this.columns[1]; }
    get z() { return this.columns[2]; }
    transposed() { return new Basis(...[0, 1, 2].map((r) => new Vector3(...this.columns.map((c) => c.n[r])))); }
    get_rotation_quaternion() {
        const m = new THREE.Matrix4();
        this.columns.forEach((c, i) => c.n.forEach((v, r) => (m.elements[4 * i + r] = v)));
        return new Quaternion(...new THREE.Quaternion().setFromRotationMatrix(m));
    }
}
class Transform3D {
    static IDENTITY = new Transform3D(new Basis(), Vector3.ZERO);
    constructor(basis, origin) { Object.assign(this, { basis, origin }); }
}

const plus = (a, b) => (typeof a === 'number' ? a + b : a.map((v, i) => v + b.n[i]));
const minus = (a, b) => (typeof a === 'number' ? a - b : a.map((v, i) => v - b.n[i]));
function times(a, b) {
    if (typeof a === 'number') return typeof b === 'number' ? a * b : b.map((v) => a * v);
    if (typeof b === 'number') return times(b, a);
    if (a instanceof Quaternion) {
        const [p, q] = [a, b].map((v) => new THREE.Quaternion(v.n[0], v.n[1], v.n[2], v.n[3] ?? 0));
        if (b instanceof Quaternion) return new Quaternion(...p.multiply(q));
        return new Vector3(...new THREE.Vector3(...b.n).applyQuaternion(p));
    }
    if (a instanceof Basis) return b instanceof Basis ? new Basis(...b.columns.map((c) => times(a, c))) : a.columns.reduce((sum, c, i) => plus(sum, times(b.n[i], c)), Vector3.ZERO);
    if (a instanceof Transform3D && b instanceof Vector3) return plus(times(a.basis, b), a.origin);
    throw new Error(`no product of ${a.constructor.name} and ${b.constructor.name}`);
}
const binary = {
    '+': plus, '-': minus, '*': times, '/': (a, b) => (typeof a === 'number' ? a / b : a.map((v) => v / b)), '<': (a, b) => a < b, '>': (a, b) => a > b, '<=': (a, b) => a <= b, '>=': (a, b) => a >= b,
    '==': (a, b) => a === b, '!=': (a, b) => a !== b,
};
const arrays = {
    size: (a) => a.length, is_empty: (a) => a.length === 0, map: (a, f) => a.map((x) => f(x)), append: (a, x) => void a.push(x), append_array: (a, b) => void a.push(...b),
    assign: (a, b) => void a.splice(0, a.length, ...b), resize: (a, n) => void (a.length = n), fill: (a, x) => void a.fill(x),
};
const dictionaries = { has: (d, key) => key in d, get: (d, key, other) => d[key] ?? other, is_empty: (d) => Object.keys(d).length === 0 };

const runtime = {
    $op: (sign, a, b) => binary[sign](a, b),
    $call(object, name, ...given) {
        if (typeof object === 'string' && name === 'validate_node_name') return object.replace(/[.:@/"%]/g, '_');
        const methods = Array.isArray(object) ? arrays : Object.getPrototypeOf(object) === Object.prototype && !(name in object) ? dictionaries : null;
        return methods ? methods[name](object, ...given) : object[name](...given);
    },
    $at(object, key) {
        const value = object instanceof Basis ? object.columns[key] : object[key];
        if (value === undefined) throw new Error(`there is no [${key}]`);
        return value;
    },
    $put: (object, key, value) => (object instanceof Basis ? (object.columns[key] = value) : (object[key] = value)),
    // A dictionary gives its keys; numbers are numbers there.
    $each: (list) => (typeof list === 'number' ? Array.from({ length: list }, (_, i) => i) : Symbol.iterator in list ? list : Object.keys(list).map((key) => (Number.isInteger(Number(key)) ? Number(key) : key))),
    $make: (type, ...given) => (type === String ? String(...given) : new type(...given)),
    Vector3, Vector4, Quaternion, Basis, Transform3D, String,
    NAN: NaN, is_nan: Number.isNaN, absf: Math.abs, tanh: Math.tanh, sin: Math.sin, cos: Math.cos, atan2: Math.atan2, maxi: Math.max, maxf: Math.max, sqrt: Math.sqrt, pow: Math.pow, int: Math.trunc,
    assert(good, text) { if (!good) throw new Error(text); },
    FileAccess: {
        READ: 1,
        open(path) {
            const bytes = fs.readFileSync(path);
            let at = 0;
            return {
                seek: (to) => (at = to),
                get_32: () => bytes.readUInt32LE((at += 4) - 4),
                get_buffer: (size) => ({ get_string_from_utf8: () => bytes.toString('utf8', at, (at += size)) }),
            };
        },
    },
    JSON: { parse_string: JSON.parse },
};

// ---- translation -----------------------------------------------------------------------------------------------------

const kTypes = ['Vector3', 'Vector4', 'Quaternion', 'Basis', 'Transform3D', 'String'];

function list(node) { return node.namedChildren.map(expression).join(', '); }

function expression(node) {
    const kids = node.namedChildren;
    switch (node.type) {
        case 'identifier': case 'integer': case 'float': case 'string': case 'true': case 'false': return node.text;
        case 'parenthesized_expression': return `(${expression(kids[0])})`;
        case 'array': return `[${list(node)}]`;
        case 'dictionary': return '({})';
        case 'unary_operator': return unaryOperator(node, expression(kids[0]));
        case 'conditional_expression': return `(${expression(kids[1])} ? ${expression(kids[0])} : ${expression(kids[2])})`;
        case 'binary_operator': return binaryOperator(node, expression(kids[1]));
        case 'subscript': return `$at(${expression(kids[0])}, ${list(kids[1])})`;
        case 'call': return kTypes.includes(kids[0].text) ? `$make(${[kids[0].text, ...kids[1].namedChildren.map(expression)].join(', ')})` : `${kids[0].text}(${list(kids[1])})`;
        case 'attribute': return attribute(kids[0], kids.slice(1));
        case 'lambda': return `(${parameters(node)}) => {${block(kids.at(-1))}}`;
    }
    throw new Error(`line ${node.startPosition.row + 1}: no ${node.type} here`);
}

const unaryOperator = (node, value) => (node.children[0].type === 'not' ? `!(${value})` : `$op('*', -1, ${value})`);

function binaryOperator(node, second) {
    const sign = node.children[1].type, first = expression(node.namedChildren[0]);
    return sign === 'and' ? `(${first} && ${second})` : sign === 'or' ? `(${first} || ${second})` : `$op('${sign}', ${first}, ${second})`;
}

/// The parser takes a - b.c.d for (a - b.c).d: what follows belongs to the last operand.
function attribute(node, parts) {
    if (node.type === 'unary_operator') return unaryOperator(node, attribute(node.namedChildren[0], parts));
    if (node.type === 'binary_operator') return binaryOperator(node, attribute(node.namedChildren[1], parts));
    return parts.reduce((object, part) => {
        if (part.type === 'identifier') return `${object}.${part.text}`;
        const [name, given] = part.namedChildren;
        if (part.type === 'attribute_subscript') return `$at(${object}.${name.text}, ${list(given)})`;
        return `$call(${[object, `'${name.text}'`, ...given.namedChildren.map(expression)].join(', ')})`;
    }, expression(node));
}

function parameters(node) {
    return node.namedChildren.find((c) => c.type === 'parameters').namedChildren
        .map((p) => (p.type === 'identifier' ? p.text : p.namedChildren[0].text + (p.type === 'typed_default_parameter' ? ' = ' + expression(p.namedChildren.at(-1)) : ''))).join(', ');
}

function assignment(target, value) {
    return target.type === 'subscript' ? `$put(${expression(target.namedChildren[0])}, ${list(target.namedChildren[1])}, ${value})` : `${expression(target)} = ${value}`;
}

function statement(node) {
    const kids = node.namedChildren.filter((c) => c.type !== 'comment');
    switch (node.type) {
        case 'comment': return '';
        case 'variable_statement': return `let ${kids[0].text}${kids.length > 2 ? ' = ' + expression(kids.at(-1)) : ''};`;
        case 'expression_statement': return statement(kids[0]) || '';
        case 'assignment': return assignment(kids[0], expression(kids[1])) + ';';
        case 'augmented_assignment': return assignment(kids[0], `$op('${node.children[1].type[0]}', ${expression(kids[0])}, ${expression(kids[1])})`) + ';';
        case 'return_statement': return `return ${kids.length ? expression(kids[0]) : ''};`;
        case 'continue_statement': return 'continue;';
        case 'for_statement': return `for (const ${kids[0].text} of $each(${expression(kids[1])})) {${block(kids[2])}}`;
        case 'if_statement':
            return `if (${expression(kids[0])}) {${block(kids[1])}}` + kids.slice(2).map((c) =>
                c.type === 'else_clause' ? `else {${block(c.namedChildren[0])}}` : `else if (${expression(c.namedChildren[0])}) {${block(c.namedChildren[1])}}`).join('');
    }
    return expression(node) + ';';
}

function block(node) { return node.namedChildren.map(statement).join('\n'); }

/// A class of GDScript, from its text: (given) -> an object whose methods are its functions.
export function compile(text) {
    const members = [], functions = [];
    for (const node of parser.parse(text).rootNode.namedChildren) {
        if (node.type === 'variable_statement') members.push(statement(node));
        else if (node.type === 'constructor_definition') functions.push(`function _init(${parameters(node)}) {${block(node.namedChildren.at(-1))}}`);
        else if (node.type === 'function_definition') functions.push(`function ${node.namedChildren.find((c) => c.type === 'name').text}(${parameters(node)}) {${block(node.namedChildren.at(-1))}}`);
    }
    const names = functions.map((f) => f.match(/^function (\w+)/)[1]).filter((n) => n !== '_init');
    const source = `${members.join('\n')}\n${functions.join('\n')}\n_init(...given);\nreturn { ${names.join(', ')}, types: { Vector3 } };`;
    const made = new Function(...Object.keys(runtime), 'given', source);
    return (...given) => made(...Object.values(runtime), given);
}
