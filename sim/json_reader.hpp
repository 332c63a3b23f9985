#pragma once
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace asip::sim {

/// Reads the members of one JSON object and notes the first thing that is wrong, with its place
/// ("parts[2].pin: ..."). After a fault every read gives its default, so that the caller goes on in a
/// straight line.
class JsonReader {
  public:
    /// `place` is empty for the document itself. `first_fault` collects; it is shared by the readers of one
    /// document.
    JsonReader(const nlohmann::json& object, std::string place, std::string& first_fault);

    bool has(const std::string& key);
    /// Null (and a fault) if it is missing.
    const nlohmann::json* required(const std::string& key);
    std::string text(const std::string& key, const std::string& otherwise);
    double number(const std::string& key, double otherwise, double least, double most);
    bool flag(const std::string& key);
    std::vector<JsonReader> list(const std::string& key);

    /// A member nobody asked for is a misspelt one.
    void refuse_others();
    void fault(const std::string& key, const std::string& reason);
    bool faulty() const { return !first_fault_->empty(); }

  private:
    const nlohmann::json* find(const std::string& key);

    const nlohmann::json* object_;
    std::string place_;
    std::string* first_fault_;
    std::set<std::string> known_;
};

}  // namespace asip::sim
