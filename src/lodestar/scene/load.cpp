#include <lodestar/scene/import.hpp>
#include <lodestar/scene/procedural.hpp>
namespace lodestar::scene {
Result<Scene> load(const std::string& s){ if(s.rfind("builtin:",0)==0) return buildBuiltin(s.substr(8)); return importGltf(s);} 
}
