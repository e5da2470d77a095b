// SPDX-License-Identifier: MIT
// The only file that names GDAL.
#include "raster/raster_file.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <gdalwarper.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>

namespace lodestone {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// Formats of elevation grids; others stay closed, so that a raster is never a way to the network or to a database.
constexpr const char* drivers[] = {"GTiff", "SRTMHGT", "netCDF",  "AAIGrid", "VRT",         "EHdr",
                                   "HFA",   "DTED",    "USGSDEM", "ENVI",    "GRD",         "GSBG",
                                   "GS7BG", "GSAG",    "XYZ",     "BIGGIF",  "JP2OpenJPEG", nullptr};

// GDAL prints its errors; they are collected instead, for this thread, while this lives.
class Quiet {
 public:
  Quiet() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~Quiet() { CPLPopErrorHandler(); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  [[nodiscard]] static std::string message(const std::string& otherwise) {
    const std::string said = CPLGetLastErrorMsg();
    return said.empty() ? otherwise : said;
  }
};

void set_up_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    GDALAllRegister();
    GDALSetCacheMax64(10LL << 20);  // a strip of a wide raster; small, so that all rasters take about as much
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");                // no .aux.xml beside the data
    CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");  // headers beside the data are found by name
  });
}

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, CloseDataset>;

// Longitude and latitude on an ellipsoid that cannot be told from that of WGS 84.
bool is_wgs84_like(const OGRSpatialReference& system) {
  return system.IsGeographic() != 0 && std::fabs(system.GetSemiMajor() - 6378137.0) < 2.0 &&
         std::fabs(system.GetInvFlattening() - 298.257) < 0.01 &&
         std::fabs(system.GetAngularUnits() - 0.0174532925) < 1e-6;
}

bool upright(const double* transform) { return transform[2] == 0.0 && transform[4] == 0.0 && transform[1] > 0.0; }

// Metres in one of what the file says its heights are in; 0 where it is not known.
double metres_in(const std::string& unit) {
  std::string word = unit;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* name : {"", "m", "metre", "metres", "meter", "meters", "1"}) {
    if (word == name) return 1.0;
  }
  for (const char* name : {"ft", "foot", "feet"}) {
    if (word == name) return 0.3048;
  }
  for (const char* name : {"us survey foot", "us survey feet", "ftus", "us-ft"}) {
    if (word == name) return 1200.0 / 3937.0;
  }
  return 0.0;
}

// The same raster in longitude and latitude. GDAL computes it block by block when it is read, exactly, not by
// approximation, so a sample does not depend on the window in which it is asked for.
Dataset reproject(GDALDataset& dataset, const std::optional<double>& nodata) {
  OGRSpatialReference globe;
  globe.importFromEPSG(4326);
  globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  char* text = nullptr;
  globe.exportToWkt(&text);
  const std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  std::vector<std::string> words{"-of", "VRT", "-t_srs", wkt,       "-r",         "bilinear",
                                 "-et", "0",   "-ot",    "Float32", "-dstnodata", "nan"};
  if (nodata) words.insert(words.end(), {"-srcnodata", std::to_string(*nodata)});
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments.data(), nullptr);
  GDALDatasetH source = &dataset;
  int misused = 0;
  GDALDatasetH warped = GDALWarp("", nullptr, 1, &source, options, &misused);
  GDALWarpAppOptionsFree(options);
  return Dataset{GDALDataset::FromHandle(warped)};
}

}  // namespace

struct RasterFile::Handle {
  Dataset file;
  Dataset warped;  // null: the file is used as it is; closed before it
  double nodata = nan_value;
  double scale = 1.0;  // height = sample * scale + offset_m: packed samples, units other than metres
  double offset_m = 0.0;
  [[nodiscard]] GDALDataset& dataset() const { return warped ? *warped : *file; }
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { warped.reset(); }
};

class RasterFile::Lease {
 public:
  Lease(const RasterFile& owner, std::unique_ptr<Handle> handle) : owner_{owner}, handle_{std::move(handle)} {}
  ~Lease() {
    const std::lock_guard lock{owner_.mutex_};
    owner_.free_.push_back(std::move(handle_));
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  [[nodiscard]] const Handle& handle() const { return *handle_; }

 private:
  const RasterFile& owner_;
  std::unique_ptr<Handle> handle_;
};

Result<std::unique_ptr<RasterFile::Handle>> RasterFile::open_handle() const {
  const Quiet quiet;
  auto handle = std::make_unique<Handle>();
  handle->file.reset(
      GDALDataset::Open(file_.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (!handle->file) {
    return Error{ErrorCode::BadData, "it is no raster that can be read: " + Quiet::message("unknown format"),
                 file_.string()};
  }
  GDALDataset& dataset = *handle->file;
  if (dataset.GetRasterCount() < 1) {
    return Error{ErrorCode::BadData,
                 "it has no raster band; of a container name one part, as in NETCDF:\"file\":variable", file_.string()};
  }
  double transform[6] = {};
  if (dataset.GetGeoTransform(transform) != CE_None) {
    return Error{ErrorCode::BadData, "it does not say where on the globe it lies", file_.string()};
  }
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const double metres = metres_in(band.GetUnitType());
  handle->scale = band.GetScale() * (metres > 0.0 ? metres : 1.0);
  handle->offset_m = band.GetOffset() * (metres > 0.0 ? metres : 1.0);
  const OGRSpatialReference* system = dataset.GetSpatialRef();
  const bool in_degrees = system == nullptr || system->IsEmpty() != 0 || is_wgs84_like(*system);
  if (!in_degrees || !upright(transform)) {
    handle->warped = reproject(dataset, nodata_);
    if (!handle->warped) {
      return Error{ErrorCode::Unsupported, "it cannot be reprojected: " + Quiet::message("unknown coordinate system"),
                   file_.string()};
    }
    return handle;
  }
  int has_nodata = 0;
  handle->nodata = band.GetNoDataValue(&has_nodata);
  if (has_nodata == 0) handle->nodata = nan_value;
  if (nodata_) handle->nodata = *nodata_;
  return handle;
}

Status RasterFile::read_frame(const Handle& handle) {
  GDALDataset& dataset = handle.dataset();
  double t[6] = {};
  dataset.GetGeoTransform(t);
  frame_ = {dataset.GetRasterXSize(), dataset.GetRasterYSize(), t[0] + 0.5 * t[1], t[3] + 0.5 * t[5], t[1], t[5]};
  if (GDALDataTypeIsComplex(dataset.GetRasterBand(1)->GetRasterDataType()) != 0) {
    return Error{ErrorCode::Unsupported, "its samples are complex numbers, not heights", file_.string()};
  }
  const double span_deg = static_cast<double>(frame_.width) * frame_.step_x_deg;
  const double tall_deg = static_cast<double>(frame_.height) * std::fabs(frame_.step_y_deg);
  const bool finite = std::isfinite(span_deg) && std::isfinite(tall_deg) && std::isfinite(t[0]) && std::isfinite(t[3]);
  // Samples may lie on the poles, and on the antimeridian at both ends.
  const double slack_x_deg = 1.5 * frame_.step_x_deg, slack_y_deg = 1.5 * std::fabs(frame_.step_y_deg);
  if (!finite || !(frame_.step_x_deg > 0.0) || frame_.step_y_deg == 0.0 || frame_.step_x_deg > 360.0 ||
      slack_y_deg > 180.0 || span_deg > 360.0 + slack_x_deg || tall_deg > 180.0 + slack_y_deg ||
      std::fabs(t[0]) > 720.0 || std::fabs(t[3]) > 90.0 + slack_y_deg) {
    return Error{ErrorCode::BadData, "its coordinates are no degrees and it names no coordinate system",
                 file_.string()};
  }
  frame_.around = std::fabs(span_deg - 360.0) < 0.5 * frame_.step_x_deg;
  std::vector<Warning> warnings;
  const OGRSpatialReference* system = handle.file->GetSpatialRef();
  if (system == nullptr || system->IsEmpty() != 0) {
    warnings.push_back({"it names no coordinate system, taken as degrees on WGS 84", file_.string()});
  }
  const std::string unit = handle.file->GetRasterBand(1)->GetUnitType();
  if (metres_in(unit) == 0.0) {
    warnings.push_back({"its samples are in \"" + unit + "\", taken as metres", file_.string()});
  }
  return {Done{}, std::move(warnings)};
}

Result<std::unique_ptr<RasterFile>> RasterFile::open(const std::filesystem::path& file,
                                                     const std::optional<double>& nodata) {
  set_up_once();
  std::error_code fault;
  // A name with a colon may be a part of a container.
  if (!std::filesystem::exists(file, fault) && file.string().find(':') == std::string::npos) {
    return Error{ErrorCode::NotFound, "the file is not there", file.string()};
  }
  std::unique_ptr<RasterFile> raster{new RasterFile};
  raster->file_ = file;
  raster->nodata_ = nodata;
  auto handle = raster->open_handle();
  if (!handle) return handle.error();
  Status framed = raster->read_frame(**handle);
  if (!framed) return framed.error();
  raster->free_.push_back(std::move(*handle));
  return {std::move(raster), std::move(framed.warnings())};
}

RasterFile::~RasterFile() = default;

Status RasterFile::read(std::int64_t column, std::int64_t row, std::int64_t width, std::int64_t height,
                        std::span<float> samples) const {
  std::unique_ptr<Handle> handle;
  {
    const std::lock_guard lock{mutex_};
    if (!free_.empty()) {
      handle = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (!handle) {
    auto opened = open_handle();
    if (!opened) return opened.error();
    handle = std::move(*opened);
  }
  const Lease lease{*this, std::move(handle)};
  const Quiet quiet;
  GDALRasterBand* band = lease.handle().dataset().GetRasterBand(1);
  const CPLErr failed = band->RasterIO(GF_Read, static_cast<int>(column), static_cast<int>(row),
                                       static_cast<int>(width), static_cast<int>(height), samples.data(),
                                       static_cast<int>(width), static_cast<int>(height), GDT_Float32, 0, 0, nullptr);
  if (failed != CE_None) {
    return Error{ErrorCode::BadData, "samples cannot be read: " + Quiet::message("unknown reason"),
                 file_.string() + ", row " + std::to_string(row) + ", column " + std::to_string(column)};
  }
  const auto nodata = static_cast<float>(lease.handle().nodata);
  const double scale = lease.handle().scale, offset_m = lease.handle().offset_m;
  const bool packed = scale != 1.0 || offset_m != 0.0;
  for (float& sample : samples) {
    if (sample == nodata) sample = std::numeric_limits<float>::quiet_NaN();
    if (packed) sample = static_cast<float>(sample * scale + offset_m);
    if (!std::isfinite(sample)) sample = std::numeric_limits<float>::quiet_NaN();
  }
  return Done{};
}

}  // namespace lodestone
