// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_file.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "asip/text/file_text.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::sim::world {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr double kFarMm = 100'000;
constexpr std::size_t kMaxLinePoints = 10'000;
constexpr std::size_t kMaxObstacles = 1'000;

bool is_coordinate(const json& value) {
    return value.is_number() && std::abs(value.get<double>()) <= kFarMm;
}

std::vector<Point> read_line(JsonReader& reader) {
    std::vector<Point> line;
    const auto* points = reader.required("line");
    if (points == nullptr) return line;
    if (!points->is_array() || points->size() > kMaxLinePoints) {
        reader.fault("line", "is a list of at most 10000 points [x, y]");
        return line;
    }
    for (const auto& point : *points) {
        if (!point.is_array() || point.size() != 2 || !is_coordinate(point[0]) || !is_coordinate(point[1])) {
            reader.fault("line", fmt::format("{} is not a point [x, y] in millimetres", point.dump()));
            return line;
        }
        line.push_back({point[0], point[1]});
    }
    return line;
}

void read_track(JsonReader reader, WorldSpec& spec) {
    if (reader.has("path")) {
        auto line = read_svg_path(reader.text("path"));
        if (!line) reader.fault("path", line.error());
        if (line) spec.line = std::move(*line);
    } else {
        spec.line = read_line(reader);
    }
    spec.width_mm = reader.number("width", spec.width_mm, 1, 200);
    spec.off_mm = reader.number("off", spec.off_mm, 1, 10'000);
    reader.refuse_others();
    if (!reader.ok()) return;
    if (auto track = Track::create(spec.line, spec.width_mm); !track) reader.fault("", track.error());
}

void read_rover(JsonReader reader, RoverSpec& rover) {
    rover.wheel_mm = reader.number("wheel", rover.wheel_mm, 1, 1000);
    rover.rpm = reader.number("rpm", rover.rpm, 1, 10'000);
    // 8 kHz at the firmware's encoders is what it can count
    rover.encoder_cycles = reader.number("encoder_cycles", rover.encoder_cycles, 1, 4000);
    rover.base_mm = reader.number("base", rover.base_mm, 10, 2000);
    rover.radius_mm = reader.number("radius", rover.radius_mm, 1, 2000);
    rover.lag_ms = reader.number("lag_ms", rover.lag_ms, 0, 10'000);
    rover.dead_band = reader.number("dead_band", rover.dead_band, 0, 1);
    rover.slip = reader.number("slip", rover.slip, 0, 0.9);
    rover.sensor_pitch_mm = reader.number("sensor_pitch", rover.sensor_pitch_mm, 1, 200);
    rover.sensor_ahead_mm = reader.number("sensor_ahead", rover.sensor_ahead_mm, -500, 500);
    rover.spot_mm = reader.number("spot", rover.spot_mm, 0.1, 100);
    rover.white = reader.number("white", rover.white, 0, 1023);
    rover.black = reader.number("black", rover.black, 0, 1023);
    rover.noise = reader.number("noise", rover.noise, 0, 500);
    reader.refuse_others();
}

Obstacle read_obstacle(JsonReader& reader) {
    const Obstacle obstacle{{reader.number("x", 0, -kFarMm, kFarMm), reader.number("y", 0, -kFarMm, kFarMm)},
                            reader.number("r", 50, 1, kFarMm)};
    reader.refuse_others();
    return obstacle;
}

WorldSpec read_world(JsonReader reader) {
    WorldSpec spec;
    if (reader.required("track") != nullptr)
        if (auto track = reader.object("track")) read_track(*track, spec);
    if (auto rover = reader.object("rover")) read_rover(*rover, spec.rover);
    for (auto& obstacle : reader.list("obstacles", kMaxObstacles))
        spec.obstacles.push_back(read_obstacle(obstacle));
    if (const auto seed = reader.integer("seed", 0, 0xffff'ffff)) spec.seed = static_cast<unsigned>(*seed);
    reader.refuse_others();
    return spec;
}

}  // namespace

Expected<std::shared_ptr<World>> parse_world(std::string_view text, const std::filesystem::path& file) {
    const auto document = json::parse(text, nullptr, false);
    if (document.is_discarded()) return fail(file.string() + ": is not correct JSON");
    std::string fault;
    const auto spec = read_world(JsonReader(document, "", fault));
    if (!fault.empty()) return fail(file.string() + ": " + fault);
    return World::create(spec);
}

Expected<std::shared_ptr<World>> load_world(const std::filesystem::path& file) {
    const auto text = text::file_text(file);
    if (!text) return fail(fmt::format("{}: cannot read the world file: {}", file.string(), text.error()));
    return parse_world(*text, file);
}

}  // namespace asip::sim::world
