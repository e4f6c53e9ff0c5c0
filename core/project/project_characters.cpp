// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "core/document/command_support.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kCharacterTables = R"(
CREATE TABLE characters (id INTEGER PRIMARY KEY, name TEXT, mesh INTEGER, part BLOB, vertices BLOB, triangles BLOB, body_vertices BLOB, how INTEGER,
    distance_rms REAL, distance_largest REAL, volume_error REAL, gap_area REAL, gap_widest REAL, gap_narrowest REAL, gap_places BLOB, detail REAL, components INTEGER);
CREATE TABLE body_links (character INTEGER, position INTEGER, start BLOB, end BLOB, radius REAL, volume REAL, PRIMARY KEY (character, position));
CREATE TABLE character_parts (character INTEGER, position INTEGER, name TEXT, PRIMARY KEY (character, position));
CREATE TABLE character_issues (character INTEGER, position INTEGER, severity INTEGER, code TEXT, text TEXT, count INTEGER, fixed INTEGER,
    triangles BLOB, vertices BLOB, PRIMARY KEY (character, position));
CREATE TABLE cuts (id INTEGER PRIMARY KEY, character INTEGER, position INTEGER, name TEXT, origin BLOB, normal BLOB, visible INTEGER, locked INTEGER);
CREATE TABLE pieces (element INTEGER PRIMARY KEY, character INTEGER, vertices BLOB, triangles BLOB);
CREATE TABLE piece_sides (element INTEGER, position INTEGER, cut INTEGER, front INTEGER, face TEXT, PRIMARY KEY (element, position));
)";

constexpr double kLargestFigure = 1e12;  // of a report's figures, which are in diagonals or relative
constexpr double kLargestVolume = 1e27;  // m^3, of what fits into the largest coordinates

Points pointsOf(const std::vector<Vec3>& places) {
    Points points(static_cast<Eigen::Index>(places.size()), 3);
    for (std::size_t i = 0; i < places.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = places[i].transpose();
    return points;
}

bool allWithinOrNone(const std::vector<std::int32_t>& values, Eigen::Index count) {
    return std::all_of(values.begin(), values.end(), [&](std::int32_t v) { return v >= -1 && v < count; });
}

CharacterSource readCharacter(RowReader& rows, const ReadMeshes& meshes) {
    CharacterSource c;
    c.id = readId(rows);
    c.name = rows.text();
    const auto mesh = meshes.find(rows.integer());
    require(mesh != meshes.end(), "a mesh is missing");
    RenderModel model{*mesh->second, rows.array<std::int32_t>(), {}};
    Body body;
    readColumns(rows, body.mesh.vertices, body.mesh.triangles, body.bodyVertex);
    const Eigen::Index vertices = body.mesh.vertices.rows();
    require(vertices >= 4 && body.mesh.triangles.rows() >= 4, "the body of a character is empty");
    require(allCoordinates(body.mesh.vertices) && allWithin(body.mesh.triangles, vertices), "the body of a character is broken");
    require(static_cast<Eigen::Index>(model.part.size()) == model.mesh.body.triangles.rows(), "the parts of a character have a broken size");
    require(static_cast<Eigen::Index>(body.bodyVertex.size()) == model.mesh.body.vertices.rows() && allWithinOrNone(body.bodyVertex, vertices),
            "the body vertices of a character are out of range");
    BodyReport& report = body.report;
    const auto figure = [](double& to) { return Within{to, 0.0, kLargestFigure}; };
    Points places;
    readColumns(rows, Within{report.how, BodyKind::Exact, BodyKind::Wrapped}, figure(report.distanceRms), figure(report.distanceLargest),
                Within{report.volumeError, -1.0, kLargestFigure}, figure(report.gaps.area), figure(report.gaps.widest), figure(report.gaps.narrowest), places);
    require(allCoordinates(places), "a point is out of range");
    for (Eigen::Index i = 0; i < places.rows(); ++i) report.gaps.places.emplace_back(places.row(i).transpose());
    readColumns(rows, Within{report.detail, 0.0, 1.0}, Within{report.components, 0, std::numeric_limits<int>::max()});
    c.model = std::make_shared<const RenderModel>(std::move(model));
    c.body = std::make_shared<const Body>(std::move(body));
    return c;
}

void readCuts(Database& db, Document& document) {
    RowReader cuts(db, "SELECT * FROM cuts ORDER BY character, position");
    while (cuts.next()) {
        Cut cut;
        cut.id = readId(cuts);
        const PartId character = readId(cuts);
        require(document.characters.contains(character), "a cut belongs to no character");
        readPosition(cuts, document.characters.at(character)->cuts.size());
        cut.name = cuts.text();
        require(checkNewName(document, cut.name).has_value(), "a name is broken or used twice");
        readColumns(cuts, cut.plane.origin, cut.plane.normal, cut.visible, cut.locked);
        require(cut.plane.normal.cwiseAbs().maxCoeff() > 0.0, "the plane of a cut has no normal");
        exchangePart(document.characters, character, [&](CharacterSource& c) { c.cuts.push_back(std::move(cut)); });
    }
}

void readPieces(Database& db, Document& document) {
    RowReader pieces(db, "SELECT * FROM pieces ORDER BY element");
    while (pieces.next()) {
        const PartId id = readId(pieces), character = readId(pieces);
        require(document.elements.contains(id) && document.characters.contains(character), "a piece belongs to nothing");
        PieceOrigin origin;
        readColumns(pieces, origin.vertices, origin.triangles);
        const TriangleMesh &whole = document.characters.at(character)->body->mesh, &body = document.elements.at(id)->mesh->body;
        require(static_cast<Eigen::Index>(origin.vertices.size()) == body.vertices.rows() && static_cast<Eigen::Index>(origin.triangles.size()) == body.triangles.rows(),
                "the origin of a piece has a broken size");
        require(allWithinOrNone(origin.vertices, whole.vertices.rows()) && allWithinOrNone(origin.triangles, whole.triangles.rows()), "the origin of a piece is out of range");
        exchangePart(document.elements, id, [&](Element& e) { e.piece = CharacterPiece{character, {}, std::make_shared<const PieceOrigin>(std::move(origin))}; });
    }
    std::set<std::pair<PartId, bool>> once;
    RowReader sides(db, "SELECT * FROM piece_sides ORDER BY element, position");
    while (sides.next()) {
        const PartId id = readId(sides);
        require(document.elements.contains(id) && document.elements.at(id)->piece, "a side of a cut belongs to nothing");
        const Element& element = *document.elements.at(id);
        const auto& known = element.piece->sides;
        readPosition(sides, known.size());
        CutSide side;
        side.cut = readId(sides);
        readColumns(sides, side.front, side.face);
        require(document.characters.at(element.piece->character)->cutIndex(side.cut) >= 0, "a side of a cut belongs to nothing");
        require((known.empty() || known.back().cut < side.cut) && once.emplace(side.cut, side.front).second, "a cut has two elements on one side");
        require(side.face.empty() || (element.faceIndex(side.face) >= 0 && std::none_of(known.begin(), known.end(), [&](const CutSide& s) { return s.face == side.face; })),
                "the joint face of a cut is broken");
        exchangePart(document.elements, id, [&](Element& e) { e.piece->sides.push_back(std::move(side)); });
    }
    for (const auto& [id, character] : document.characters) {
        require(document.elementsOf(id).size() == character->cuts.size() + 1, "a character has other elements than cuts");
        for (const Cut& cut : character->cuts) require(once.contains({cut.id, false}) && once.contains({cut.id, true}), "a cut has no element on one side");
    }
}

}  // namespace

void createCharacterTables(Database& db) { db.run(kCharacterTables); }

void writeCharacters(Database& db, const Document& document, const MeshIds& meshes) {
    RowWriter characters(db, "INSERT INTO characters VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"), links(db, "INSERT INTO body_links VALUES (?,?,?,?,?,?)"), parts(db, "INSERT INTO character_parts VALUES (?,?,?)"),
        issues(db, "INSERT INTO character_issues VALUES (?,?,?,?,?,?,?,?,?)"), cuts(db, "INSERT INTO cuts VALUES (?,?,?,?,?,?,?,?)");
    for (const auto& [id, c] : document.characters) {
        const BodyReport& r = c->body->report;
        characters.row(id, c->name, meshes.at(&c->model->mesh), c->model->part, c->body->mesh.vertices, c->body->mesh.triangles, c->body->bodyVertex, static_cast<int>(r.how),
                       r.distanceRms, r.distanceLargest, r.volumeError, r.gaps.area, r.gaps.widest, r.gaps.narrowest, pointsOf(r.gaps.places), r.detail, r.components);
        for (std::size_t i = 0; i < r.links.size(); ++i) links.row(id, i, r.links[i].from, r.links[i].to, r.links[i].radius, r.links[i].volume);
        for (std::size_t i = 0; i < c->model->parts.size(); ++i) parts.row(id, i, c->model->parts[i]);
        for (std::size_t i = 0; i < c->issues.size(); ++i) {
            const MeshIssue& issue = c->issues[i];
            issues.row(id, i, static_cast<int>(issue.severity), issue.code, issue.text, issue.count, issue.fixed, issue.triangles, issue.vertices);
        }
        for (std::size_t i = 0; i < c->cuts.size(); ++i) cuts.row(c->cuts[i].id, id, i, c->cuts[i].name, c->cuts[i].plane.origin, c->cuts[i].plane.normal, c->cuts[i].visible, c->cuts[i].locked);
    }
    RowWriter pieces(db, "INSERT INTO pieces VALUES (?,?,?,?)"), sides(db, "INSERT INTO piece_sides VALUES (?,?,?,?,?)");
    for (const auto& [id, element] : document.elements) {
        if (!element->piece) continue;
        pieces.row(id, element->piece->character, element->piece->origin->vertices, element->piece->origin->triangles);
        for (std::size_t i = 0; i < element->piece->sides.size(); ++i) {
            const CutSide& side = element->piece->sides[i];
            sides.row(id, i, side.cut, side.front, side.face);
        }
    }
}

void readCharacters(Database& db, Document& document, const ReadMeshes& meshes) {
    std::map<PartId, CharacterSource> read;
    RowReader rows(db, "SELECT * FROM characters ORDER BY id");
    while (rows.next()) {
        CharacterSource c = readCharacter(rows, meshes);
        const PartId id = c.id;
        read.emplace(id, std::move(c));
    }
    const auto characterAt = [&](PartId part) -> CharacterSource& {
        const auto found = read.find(part);
        require(found != read.end(), "a character is missing");
        return found->second;
    };
    std::map<PartId, std::vector<FleshLink>> linksOf;
    RowReader links(db, "SELECT * FROM body_links ORDER BY character, position");
    while (links.next()) {
        const PartId id = readId(links);
        (void)characterAt(id);
        readPosition(links, linksOf[id].size());
        FleshLink link;
        readColumns(links, link.from, link.to, Within{link.radius, 0.0, kMaxCoordinate}, Within{link.volume, -kLargestVolume, kLargestVolume});
        linksOf[id].push_back(link);
    }
    std::map<PartId, std::vector<std::string>> names;
    RowReader parts(db, "SELECT * FROM character_parts ORDER BY character, position");
    while (parts.next()) {
        const PartId id = readId(parts);
        (void)characterAt(id);
        readPosition(parts, names[id].size());
        names[id].push_back(readUtf8(parts));
    }
    RowReader issues(db, "SELECT * FROM character_issues ORDER BY character, position");
    while (issues.next()) {
        CharacterSource& c = characterAt(readId(issues));
        readPosition(issues, c.issues.size());
        c.issues.push_back(readIssue(issues, c.model->mesh.body));
    }
    for (auto& [id, character] : read) {
        RenderModel model = *character.model;
        model.parts = std::move(names[id]);
        require(allWithin(model.part, static_cast<Eigen::Index>(model.parts.size())), "a triangle names a part that is not there");
        character.model = std::make_shared<const RenderModel>(std::move(model));
        if (auto& made = linksOf[id]; !made.empty()) {
            Body body = *character.body;
            body.report.links = std::move(made);
            character.body = std::make_shared<const Body>(std::move(body));
        }
        require(checkNewName(document, character.name).has_value(), "a name is broken or used twice");
        document.characters.emplace(id, std::make_shared<const CharacterSource>(std::move(character)));
    }
    readCuts(db, document);
    readPieces(db, document);
}

}  // namespace imomushi
