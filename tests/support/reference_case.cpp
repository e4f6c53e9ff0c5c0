// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/reference_case.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/obj.h"

namespace imomushi {
namespace {

using nlohmann::json;

constexpr double kReferenceSteps = 1e5;

std::ifstream open(const std::string& folder, const std::string& file) {
    std::ifstream stream(folder + "/" + file);
    if (!stream) throw std::runtime_error(folder + "/" + file + " cannot be read.");
    return stream;
}

json readJson(const std::string& folder, const std::string& file) {
    std::ifstream stream = open(folder, file);
    return json::parse(stream);
}

}  // namespace

double ReferenceBody::diagonal() const {
    return (mesh->body.vertices.colwise().maxCoeff() - mesh->body.vertices.colwise().minCoeff()).norm();
}

ReferenceBody readReferenceBody(const std::string& folder, const std::string& name) {
    ReferenceBody body;
    body.name = name;
    body.mesh = std::make_shared<ElementMesh>();
    body.mesh->body = readObj(folder + "/" + name + ".obj");

    const json facts = readJson(folder, name + ".faces.json");
    std::vector<bool> held(static_cast<std::size_t>(body.mesh->body.vertices.rows()), false);
    for (const json& fact : facts["faces"]) {
        auto face = jointFaceByVertices(body.mesh->body, fact["vertices"].get<std::vector<std::int32_t>>());
        if (!face) throw std::runtime_error(name + ": " + face.error().message);
        face->name = fact["name"];
        for (const std::int32_t v : face->vertices) held[static_cast<std::size_t>(v)] = true;
        body.faces.push_back(std::move(*face));
    }
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) body.freeVertices.push_back(static_cast<std::int32_t>(v));
    return body;
}

std::vector<ReferenceCase> readReferenceCases(const std::string& folder, const std::string& name) {
    std::vector<ReferenceCase> cases;
    const json answers = readJson(folder, name + ".json");
    for (const json& result : answers["results"]) {
        ReferenceCase one;
        one.name = result["case"];
        one.nu = result["nu"];
        for (const auto& [face, p] : result["faces"].items())
            one.faces[face] = {p.value("a", 1.0), p.value("b", 1.0), p.value("theta1", 0.0), p.value("theta2", 0.0), p.value("dz", 0.0)};
        const json& rows = result["displacement"];
        one.displacement.resize(static_cast<Eigen::Index>(rows.size()), 3);
        for (std::size_t v = 0; v < rows.size(); ++v)
            for (std::size_t k = 0; k < 3; ++k) one.displacement(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k)) = rows[v][k];
        cases.push_back(std::move(one));
    }
    return cases;
}

std::vector<ReferenceModes> readReferenceModes(const std::string& folder, const std::string& name) {
    std::vector<ReferenceModes> out;
    if (!std::filesystem::exists(folder + "/" + name + ".modes.json")) return out;
    const json all = readJson(folder, name + ".modes.json");
    for (const json& one : all["results"]) {
        ReferenceModes& modes = out.emplace_back();
        modes.nu = one["nu"];
        modes.vertices = all["vertices"].get<std::vector<std::int32_t>>();
        for (const json& column : one["modes"]) {
            const double unit = column["unit"];
            const json& values = column["displacement"];
            Points& u = modes.displacement.emplace_back(static_cast<Eigen::Index>(modes.vertices.size()), 3);
            for (Eigen::Index i = 0; i < u.size(); ++i) u.data()[i] = unit * values[static_cast<std::size_t>(i)].get<double>();
        }
    }
    return out;
}

void writeReferenceModes(const std::string& folder, const std::string& name, const std::vector<ReferenceModes>& modes) {
    json all;
    all["vertices"] = modes.front().vertices;
    for (const ReferenceModes& one : modes) {
        json& result = all["results"].emplace_back();
        result["nu"] = one.nu;
        for (const Points& u : one.displacement) {
            const double unit = u.cwiseAbs().maxCoeff() / kReferenceSteps;
            json& column = result["modes"].emplace_back();
            column["unit"] = unit;
            for (Eigen::Index i = 0; i < u.size(); ++i) column["displacement"].push_back(std::lround(u.data()[i] / unit));
        }
    }
    std::ofstream(folder + "/" + name + ".modes.json") << all.dump() << "\n";
}

Points faceDisplacement(const ReferenceBody& body, const ReferenceCase& wanted, const Points& points,
                        const std::vector<std::vector<std::int32_t>>& onFace) {
    Points result = Points::Zero(points.rows(), 3);
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const auto parameters = wanted.faces.find(body.faces[f].name);
        if (parameters == wanted.faces.end()) continue;
        const JointMap map = jointMap(parameters->second);
        for (const std::int32_t i : onFace[f]) {
            Vec3 local = body.faces[f].frame.toLocal(points.row(i).transpose());
            local.z() = 0.0;
            result.row(i) = (body.faces[f].frame.axes * (map.linear * local + map.shift - local)).transpose();
        }
    }
    return result;
}

ReferenceError referenceError(const ReferenceBody& body, const Points& displacement, const Points& reference) {
    double error = 0.0, free = 0.0;
    for (const std::int32_t v : body.freeVertices) {
        error += (displacement.row(v) - reference.row(v)).squaredNorm();
        free += reference.row(v).squaredNorm();
    }
    return {std::sqrt(error / free), std::sqrt(error) / reference.norm()};
}

}  // namespace imomushi
