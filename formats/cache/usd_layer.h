#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// A USD layer in general: prims, their properties and the values of these, apart from the encoding
/// in which a file has them. usd_cache.h builds layers of sheets on it.
namespace paperbake::usd {

struct Token {
  std::string text;
};

/// float[], float2[], float3[] or float4[], or a type with a role such as point3f[].
struct FloatArray {
  std::size_t width = 1;      // numbers of an element
  std::vector<float> values;  // of all elements, one after another
};

inline bool operator==(const Token& a, const Token& b) { return a.text == b.text; }
inline bool operator==(const FloatArray& a, const FloatArray& b) {
  return a.width == b.width && a.values == b.values;
}

using Value = std::variant<bool, double, std::string, Token, std::vector<double>, std::vector<int>,
                           FloatArray, std::vector<Token>>;

/// A value that an encoder has stored. Equal values of one type have equal numbers.
using StoredValue = std::uint64_t;

struct TimeSample {
  long time_code;
  StoredValue value;
};

/// An attribute or a relationship.
struct Property {
  std::string type, name;          // "point3f[]", "points"; a relationship has no type
  std::string interpolation = {};  // "vertex"; empty: it says none
  bool uniform = false, custom = false;
  std::vector<TimeSample> samples = {};  // one value for all times when they are equal
  std::string target = {};               // of a relationship: path of a prim of the layer

  bool varies() const {
    return std::any_of(samples.begin(), samples.end(), [this](const TimeSample& sample) {
      return sample.value != samples.front().value;
    });
  }
};

struct Prim {
  // "Mesh", an identifier; without a type it is an `over`, which adds to a prim of another layer
  std::string type, name;
  std::string kind = {}, display_name = {};   // empty: none
  std::vector<std::string> api_schemas = {};  // "MaterialBindingAPI"
  std::vector<Property> properties = {};
  std::vector<Prim> children = {};
};

/// Y up, metres.
struct Layer {
  std::vector<std::pair<std::string, std::string>> metadata;  // identifier, text
  std::vector<std::string> sub_layers = {};                   // relative paths, the strongest first
  long first_frame = 1, last_frame = 1;
  double fps = 24;
  Prim root;
};

/// Writes a layer: first its values, as they come, then the prims that refer to them. The file is
/// an AtomicFile; the same calls write the same bytes. All functions throw
/// Error(ErrorCode::folder) when the disk is full or the file cannot be created.
class Encoder {
 public:
  virtual ~Encoder() = default;

  virtual StoredValue store(const Value&) = 0;
  /// Writes prims and properties and gives the file its name; the last call.
  virtual void finish(const Layer&) = 0;
};

/// The text form, .usda. A layer lists the samples of one attribute after another, so values are
/// kept in a temporary file until then.
/// source  the usda format as OpenUSD 26 reads it
std::unique_ptr<Encoder> make_text_encoder(const std::filesystem::path&);

/// The binary form, .usdc, version 0.8.0. Values go to the file as they come, arrays of integers
/// compressed, equal ones once.
/// source  the crate format as OpenUSD 26 reads it
std::unique_ptr<Encoder> make_crate_encoder(const std::filesystem::path&);

}  // namespace paperbake::usd
