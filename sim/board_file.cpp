#include "sim/board_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "sim/board_kind.hpp"
#include "sim/json_reader.hpp"
#include "sim/nearest.hpp"
#include "sim/pin_claims.hpp"

namespace asip::sim {
namespace {

using nlohmann::json;

const std::vector<std::string> kKinds = {"led",        "button", "wire",       "potentiometer",
                                         "ultrasonic", "servo",  "square-wave"};

int read_pin(JsonReader& reader, const std::string& key, const BoardKind& kind) {
    const auto* value = reader.required(key);
    if (value == nullptr) return 0;
    const auto text = value->is_string() ? value->get<std::string>() : value->dump();
    const auto pin = kind.parse_pin(text);
    if (!pin) reader.fault(key, pin.error());
    return pin.value_or(0);
}

PartSpec read_spec(JsonReader& reader, const std::string& name_of_kind, const BoardKind& kind) {
    if (name_of_kind == "led") return LedSpec{read_pin(reader, "pin", kind), reader.flag("active_low")};
    if (name_of_kind == "button") return ButtonSpec{read_pin(reader, "pin", kind), reader.flag("to_vcc")};
    if (name_of_kind == "wire") return WireSpec{read_pin(reader, "from", kind), read_pin(reader, "to", kind)};
    if (name_of_kind == "potentiometer")
        return PotentiometerSpec{read_pin(reader, "pin", kind), reader.number("position", 0.5, 0, 1)};
    if (name_of_kind == "servo") return ServoSpec{read_pin(reader, "pin", kind)};
    if (name_of_kind == "square-wave")
        return SquareWaveSpec{read_pin(reader, "pin", kind), reader.number("hertz", 1, 0, 1e6)};
    UltrasonicSpec sensor;
    if (reader.has("trigger")) {
        sensor.trigger = read_pin(reader, "trigger", kind);
        sensor.echo = read_pin(reader, "echo", kind);
    } else {
        sensor.trigger = sensor.echo = read_pin(reader, "pin", kind);
    }
    sensor.distance_cm = reader.number("distance", 100, 0, 10000);
    return sensor;
}

int first_pin(const PartSpec& spec) {
    return std::visit(
        [](const auto& s) {
            if constexpr (requires { s.pin; })
                return s.pin;
            else if constexpr (requires { s.from; })
                return s.from;
            else
                return s.trigger;
        },
        spec);
}

PartConfig read_part(JsonReader reader, const BoardKind& kind) {
    PartConfig part;
    const auto kind_name = reader.text("kind", "");
    if (kind_name.empty())
        reader.fault("kind", fmt::format("missing; one of {}", fmt::join(kKinds, ", ")));
    else if (std::find(kKinds.begin(), kKinds.end(), kind_name) == kKinds.end())
        reader.fault("kind", fmt::format("there is no part \"{}\"{}; one of {}", kind_name,
                                         did_you_mean(kind_name, kKinds), fmt::join(kKinds, ", ")));
    else
        part.spec = read_spec(reader, kind_name, kind);
    part.name = reader.text("name", kind_name + std::to_string(first_pin(part.spec)));
    if (part.name.find_first_of(" \t/") != std::string::npos)
        reader.fault("name", "a part's name has no spaces and no \"/\" in it");
    reader.refuse_others();
    return part;
}

std::filesystem::path beside(const std::filesystem::path& file, const std::string& path) {
    return path.empty() ? std::filesystem::path() : file.parent_path() / path;
}

BoardFile read_board(JsonReader reader, const std::filesystem::path& file) {
    BoardFile result;
    auto& board = result.board;
    board.name = reader.text("name", file.stem().string());
    if (board.name.empty() || board.name.find_first_of(" \t/") != std::string::npos)
        reader.fault("name", "a board's name has no spaces and no \"/\" in it");
    board.board = reader.text("board", "uno");
    std::vector<std::string> boards;
    for (const auto& kind : BoardKind::all())
        boards.push_back(kind.name);
    const auto* kind = BoardKind::find(board.board);
    if (kind == nullptr) {
        reader.fault("board", fmt::format("there is no board \"{}\"{}; one of {}", board.board,
                                          did_you_mean(board.board, boards), fmt::join(boards, ", ")));
        return result;
    }
    if (reader.required("image") != nullptr) board.image = beside(file, reader.text("image", ""));
    board.eeprom = beside(file, reader.text("eeprom", ""));
    board.frequency = static_cast<std::uint32_t>(reader.number("frequency", 16e6, 1e6, 20e6));
    if (reader.has("uart"))
        board.uart = static_cast<char>('0' + static_cast<int>(reader.number("uart", 0, 0, 3)));
    result.link = beside(file, reader.text("link", ""));
    if (reader.has("tcp")) result.tcp_port = static_cast<int>(reader.number("tcp", 0, 0, 65535));
    result.reset_on_open = reader.flag("reset_on_open");
    for (auto& part : reader.list("parts"))
        board.parts.push_back(read_part(part, *kind));
    reader.refuse_others();
    if (!reader.faulty())
        if (auto checked = check_parts(board, *kind); !checked)
            reader.fault(fmt::format("parts[{}]", checked.error().index),
                         board.parts[checked.error().index].name + ": " + checked.error().reason);
    return result;
}

/// "12:5: " for a byte of the text, counted from 1 as editors do.
std::string line_and_column(std::string_view text, std::size_t byte) {
    const auto before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto line_start = before.rfind('\n');
    const auto column = before.size() - (line_start == std::string_view::npos ? 0 : line_start + 1) + 1;
    return fmt::format("{}:{}", line, column);
}

}  // namespace

Expected<BoardFile> parse_board_file(std::string_view text, const std::filesystem::path& file) {
    json document;
    try {
        document = json::parse(text);
    } catch (const json::parse_error& error) {
        std::string_view what = error.what();
        const auto reason = what.rfind("; ") != std::string_view::npos ? what.substr(what.rfind("; ") + 2)
                                                                       : std::string_view("not JSON");
        return fail(fmt::format("{}:{}: not correct JSON: {}", file.string(),
                                line_and_column(text, error.byte), reason));
    }
    std::string first_fault;
    auto board = read_board(JsonReader(document, "", first_fault), file);
    if (!first_fault.empty()) return fail(file.string() + ": " + first_fault);
    return board;
}

Expected<BoardFile> load_board_file(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error))
        return fail(file.string() + ": is a folder, not a board file");
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        return fail(fmt::format("{}: cannot read the board file: {}", file.string(), std::strerror(errno)));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return parse_board_file(text, file);
}

}  // namespace asip::sim
