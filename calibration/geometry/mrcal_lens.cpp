#include "calibration/geometry/mrcal_lens.h"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <Eigen/Cholesky>
#include <Eigen/Sparse>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>

// mrcal.h 2.2 has no extern "C" of its own and declares cholmod_sparse without its layout.
extern "C" {
#include <mrcal/mrcal.h>
#include <suitesparse/cholmod.h>

#include "calibration/geometry/rotation_vector.h"
}

namespace calibration {
namespace {

constexpr double kM_per_mm = 1e-3;  // mrcal gets metres, for which its unknowns are scaled

// mrcal keeps arrays of any size on the stack, so it runs in a thread whose stack is large enough for our problems.
void run_with_large_stack(const std::function<void()>& work) {
  struct Job {
    const std::function<void()>* work;
    std::exception_ptr error;
  } job{&work, nullptr};
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, std::size_t{64} << 20);
  pthread_t thread{};
  const int failed = pthread_create(
      &thread, &attributes,
      [](void* argument) -> void* {
        auto* mine = static_cast<Job*>(argument);
        try {
          (*mine->work)();
        } catch (...) {
          mine->error = std::current_exception();
        }
        return nullptr;
      },
      &job);
  pthread_attr_destroy(&attributes);
  if (failed != 0) throw std::runtime_error("lens calibration: no thread could be started; free some memory");
  pthread_join(thread, nullptr);
  if (job.error) std::rethrow_exception(job.error);
}

// While an object of this class lives, standard error goes to `text`. Only one lives at a time; nothing is caught when
// the system gives no descriptor for it.
class CaughtStandardError {
 public:
  explicit CaughtStandardError(std::string& text) : text_(text), lock_(mutex()) {
    std::fflush(stderr);
    caught_ = memfd_create("standard error", MFD_CLOEXEC);
    original_ = caught_ < 0 ? -1 : dup(STDERR_FILENO);
    if (original_ >= 0) dup2(caught_, STDERR_FILENO);
  }
  ~CaughtStandardError() {
    std::fflush(stderr);
    if (original_ >= 0) {
      dup2(original_, STDERR_FILENO);
      close(original_);
      char piece[512];
      lseek(caught_, 0, SEEK_SET);
      for (ssize_t n = 0; (n = read(caught_, piece, sizeof piece)) > 0;)
        text_.append(piece, static_cast<std::size_t>(n));
    }
    if (caught_ >= 0) close(caught_);
  }
  CaughtStandardError(const CaughtStandardError&) = delete;
  CaughtStandardError& operator=(const CaughtStandardError&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::string& text_;
  std::lock_guard<std::mutex> lock_;
  int caught_ = -1, original_ = -1;
};

mrcal_lensmodel_t mrcal_model(LensModel model) {
  mrcal_lensmodel_t out;
  std::memset(&out, 0, sizeof out);
  out.type = model == LensModel::opencv4   ? MRCAL_LENSMODEL_OPENCV4
             : model == LensModel::opencv5 ? MRCAL_LENSMODEL_OPENCV5
                                           : MRCAL_LENSMODEL_OPENCV8;
  return out;
}

mrcal_pose_t pose_of(const Eigen::Isometry3d& camera_from_lattice) {
  mrcal_pose_t pose;
  Eigen::Map<Eigen::Vector3d>(pose.r.xyz) = rotation_vector(camera_from_lattice.linear());
  Eigen::Map<Eigen::Vector3d>(pose.t.xyz) = camera_from_lattice.translation() * kM_per_mm;
  return pose;
}

Eigen::Isometry3d isometry_of_pose(const mrcal_pose_t& pose) {
  const Eigen::Map<const Eigen::Vector3d> r(pose.r.xyz), t(pose.t.xyz);
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  if (r.norm() > 0.0) out.linear() = Eigen::AngleAxisd(r.norm(), r.normalized()).toRotationMatrix();
  out.translation() = t / kM_per_mm;
  return out;
}

void require_sound(const LensBundle& bundle) {
  if (bundle.pictures.empty() || bundle.lattice.columns < 2 || bundle.lattice.rows < 2)
    throw std::runtime_error("lens calibration: needs a board of 2 x 2 corners or more and at least one picture");
  for (const BundlePicture& picture : bundle.pictures) {
    for (const LatticeCorner& corner : picture.corners) {
      if (!corner.pixel.allFinite())
        throw std::runtime_error("lens calibration: a corner's position is not a finite number; detect it again");
      if (corner.column < 0 || corner.row < 0 || corner.column >= bundle.lattice.columns ||
          corner.row >= bundle.lattice.rows)
        throw std::runtime_error("lens calibration: a corner lies beside the board; check the board file");
    }
  }
}

// A LensBundle in mrcal's arrays.
struct Arrays {
  mrcal_lensmodel_t model;
  std::vector<double> intrinsics;
  std::vector<mrcal_pose_t> frames;
  mrcal_calobject_warp_t warp;
  std::vector<mrcal_observation_board_t> observations;
  std::vector<mrcal_point3_t> pool;  // picture, row, column
  std::array<int, 2> image_size;
  mrcal_problem_selections_t selections;
  mrcal_problem_constants_t constants;
  double spacing;
  int columns, rows;
  int states, measurements;

  Arrays(const LensBundle& bundle, const BundleFreedom& freedom)
      : model(mrcal_model(bundle.lens.model)),
        intrinsics(bundle.lens.intrinsics),
        image_size{bundle.lens.image_size.width, bundle.lens.image_size.height},
        spacing(bundle.lattice.spacing_mm * kM_per_mm),
        columns(bundle.lattice.columns),
        rows(bundle.lattice.rows) {
    warp.x2 = bundle.warp_mm.x() * kM_per_mm;
    warp.y2 = bundle.warp_mm.y() * kM_per_mm;
    std::memset(&selections, 0, sizeof selections);
    selections.do_optimize_intrinsics_core = true;
    selections.do_optimize_intrinsics_distortions = freedom.distortion;
    selections.do_optimize_frames = true;
    selections.do_optimize_calobject_warp = freedom.warp;
    selections.do_apply_regularization = freedom.regularised;
    selections.do_apply_outlier_rejection = freedom.reject_outliers;
    constants = {.point_min_range = 0.01, .point_max_range = 100.0};  // for single points, which are not used here
    for (const BundlePicture& picture : bundle.pictures) {
      observations.push_back({.icam = {0, -1}, .iframe = static_cast<int>(frames.size())});
      frames.push_back(pose_of(picture.camera_from_lattice));
      const std::size_t first = pool.size();
      pool.resize(first + nodes(), mrcal_point3_t{{0.0, 0.0, -1.0}});
      for (std::size_t c = 0; c < picture.corners.size(); ++c) {
        const LatticeCorner& corner = picture.corners[c];
        mrcal_point3_t& point = pool[first + node(corner)];
        point.x = corner.pixel.x();
        point.y = corner.pixel.y();
        point.z = picture.used[c] ? 1.0 : -1.0;
      }
    }
    states = mrcal_num_states(1, 0, pictures(), 0, 0, pictures(), selections, &model);
    measurements = mrcal_num_measurements(pictures(), 0, columns, rows, 1, 0, pictures(), 0, 0, selections, &model);
  }

  int pictures() const { return static_cast<int>(frames.size()); }
  std::size_t nodes() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t node(const LatticeCorner& corner) const {
    return static_cast<std::size_t>(corner.row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(corner.column);
  }
};

int bytes(const std::vector<double>& buffer) {
  return static_cast<int>(buffer.size() * sizeof(double));
}

// mrcal's residuals and the transpose of their derivatives by its state, both as compressed columns: column m of the
// transpose has values[k] in row indices[k] for k from starts[m] to starts[m + 1].
struct LinearFit {
  std::vector<double> residuals, values;
  std::vector<int> starts, indices;
};

// The transpose as mrcal gets it, which fills the fit's arrays.
cholmod_sparse transpose_to_fill(LinearFit& fit, std::size_t states) {
  cholmod_sparse transposed{};
  transposed.nrow = states;
  transposed.ncol = fit.residuals.size();
  transposed.nzmax = fit.values.size();
  transposed.p = fit.starts.data();
  transposed.i = fit.indices.data();
  transposed.x = fit.values.data();
  transposed.itype = CHOLMOD_INT;
  transposed.xtype = CHOLMOD_REAL;
  transposed.dtype = CHOLMOD_DOUBLE;
  transposed.sorted = 1;
  transposed.packed = 1;
  return transposed;
}

LinearFit linear_fit(Arrays& arrays) {
  const auto states = static_cast<std::size_t>(arrays.states),
             measurements = static_cast<std::size_t>(arrays.measurements);
  const auto nonzero = static_cast<std::size_t>(
      _mrcal_num_j_nonzero(arrays.pictures(), 0, arrays.columns, arrays.rows, 1, 0, arrays.pictures(), 0, 0,
                           arrays.observations.data(), nullptr, arrays.selections, &arrays.model));
  LinearFit fit{.residuals = std::vector<double>(measurements),
                .values = std::vector<double>(nonzero),
                .starts = std::vector<int>(measurements + 1),
                .indices = std::vector<int>(nonzero)};
  std::vector<double> state(states);
  cholmod_sparse transposed = transpose_to_fill(fit, states);
  std::string messages;
  {
    const CaughtStandardError caught(messages);
    if (!mrcal_optimizer_callback(state.data(), bytes(state), fit.residuals.data(), bytes(fit.residuals), &transposed,
                                  arrays.intrinsics.data(), nullptr, arrays.frames.data(), nullptr, &arrays.warp, 1, 0,
                                  arrays.pictures(), 0, 0, arrays.observations.data(), nullptr, arrays.pictures(), 0,
                                  arrays.pool.data(), &arrays.model, arrays.image_size.data(), arrays.selections,
                                  &arrays.constants, arrays.spacing, arrays.columns, arrays.rows, false))
      throw std::runtime_error("lens calibration: mrcal could not linearise the fit: " + messages);
  }
  return fit;
}

// The corners' errors, their mean and the noise that they tell.
void add_errors(const LensBundle& bundle, const Arrays& arrays, const std::vector<double>& residuals,
                BundleUncertainty& result) {
  double squares = 0.0;
  int used = 0;
  for (std::size_t v = 0; v < bundle.pictures.size(); ++v) {
    const BundlePicture& picture = bundle.pictures[v];
    result.errors_px.emplace_back(picture.corners.size(), Eigen::Vector2d::Zero());
    for (std::size_t c = 0; c < picture.corners.size(); ++c) {
      if (!picture.used[c]) continue;
      const std::size_t row = 2 * (v * arrays.nodes() + arrays.node(picture.corners[c]));
      result.errors_px[v][c] = {residuals[row], residuals[row + 1]};
      squares += result.errors_px[v][c].squaredNorm();
      ++used;
    }
  }
  const double freedoms = 2.0 * used - static_cast<double>(arrays.states);
  result.rms_px = std::sqrt(squares / std::max(1.0, 2.0 * used));
  result.sigma_px = freedoms > 0.0 ? std::sqrt(squares / freedoms) : std::numeric_limits<double>::infinity();
}

// What a step of 1 in each number of mrcal's state is in our units; the state begins with that many intrinsics.
Eigen::VectorXd unit_steps(int intrinsics, const Arrays& arrays) {
  Eigen::VectorXd steps = Eigen::VectorXd::Ones(arrays.states);
  mrcal_unpack_solver_state_vector(steps.data(), 1, 0, arrays.pictures(), 0, 0, arrays.selections, &arrays.model);
  for (Eigen::Index i = intrinsics; i < arrays.states; ++i) {
    const bool rotation = i < intrinsics + 6 * arrays.pictures() && (i - intrinsics) % 6 < 3;
    if (!rotation) steps[i] /= kM_per_mm;
  }
  return steps;
}

// The covariance, for the noise in `result`, and the next step.
void add_covariance(int intrinsics, const Arrays& arrays, const LinearFit& fit, BundleUncertainty& result) {
  // Regularisation terms hold the solution back but carry no noise, so they are in `curvature` and not in
  // `information`.
  using Sparse = Eigen::SparseMatrix<double>;
  const Eigen::Map<const Sparse> jt(arrays.states, arrays.measurements, static_cast<Eigen::Index>(fit.values.size()),
                                    fit.starts.data(), fit.indices.data(), fit.values.data());
  const Sparse seen = jt.leftCols(mrcal_num_measurements_boards(arrays.pictures(), arrays.columns, arrays.rows));
  const Eigen::MatrixXd information = Sparse(seen * Sparse(seen.transpose()));
  const Eigen::MatrixXd curvature = Sparse(jt * Sparse(jt.transpose()));
  const Eigen::LLT<Eigen::MatrixXd> factor(curvature);
  result.covariance = Eigen::MatrixXd::Constant(arrays.states, arrays.states, std::numeric_limits<double>::infinity());
  if (factor.info() != Eigen::Success || !std::isfinite(result.sigma_px)) return;
  const Eigen::VectorXd gradient = jt * Eigen::Map<const Eigen::VectorXd>(fit.residuals.data(), arrays.measurements);
  result.step_px = std::sqrt(gradient.dot(factor.solve(gradient)));
  const Eigen::MatrixXd half = factor.solve(information);
  Eigen::MatrixXd covariance = factor.solve(half.transpose()) * (result.sigma_px * result.sigma_px);
  const Eigen::VectorXd scale = unit_steps(intrinsics, arrays);
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (covariance.allFinite()) result.covariance = 0.5 * (covariance + covariance.transpose());
}

}  // namespace

int number_of_intrinsics(LensModel model) {
  return model == LensModel::opencv4 ? 8 : model == LensModel::opencv5 ? 9 : 12;
}

ModelledLens as(LensModel model, ModelledLens lens) {
  lens.model = model;
  lens.intrinsics.resize(static_cast<std::size_t>(number_of_intrinsics(model)), 0.0);
  return lens;
}

Eigen::Vector2d project_with(const ModelledLens& lens, const Eigen::Vector3d& point_in_camera) {
  const mrcal_lensmodel_t model = mrcal_model(lens.model);
  const mrcal_point3_t point{{point_in_camera.x(), point_in_camera.y(), point_in_camera.z()}};
  mrcal_point2_t pixel;
  if (!mrcal_project(&pixel, nullptr, nullptr, &point, 1, &model, lens.intrinsics.data()))
    throw std::runtime_error("lens: a point could not be projected; calibrate again");
  return {pixel.x, pixel.y};
}

Eigen::Vector3d ray_of(const ModelledLens& lens, const Eigen::Vector2d& pixel) {
  const mrcal_lensmodel_t model = mrcal_model(lens.model);
  mrcal_point2_t seen;
  seen.x = pixel.x();
  seen.y = pixel.y();
  mrcal_point3_t ray;
  if (!mrcal_unproject(&ray, &seen, 1, &model, lens.intrinsics.data()))
    throw std::runtime_error("lens: a pixel has no ray; calibrate again");
  return Eigen::Vector3d(ray.x, ray.y, ray.z).normalized();
}

BundleOutcome solve_bundle(LensBundle& bundle, const BundleFreedom& freedom) {
  require_sound(bundle);
  BundleOutcome outcome;
  run_with_large_stack([&] {
    Arrays arrays(bundle, freedom);
    std::vector<double> state(static_cast<std::size_t>(arrays.states)),
        residuals(static_cast<std::size_t>(arrays.measurements));
    {
      const CaughtStandardError caught(outcome.messages);
      mrcal_optimize(state.data(), bytes(state), residuals.data(), bytes(residuals), arrays.intrinsics.data(), nullptr,
                     arrays.frames.data(), nullptr, &arrays.warp, 1, 0, arrays.pictures(), 0, 0,
                     arrays.observations.data(), nullptr, arrays.pictures(), 0, arrays.pool.data(), &arrays.model,
                     arrays.image_size.data(), arrays.selections, &arrays.constants, arrays.spacing, arrays.columns,
                     arrays.rows, false, false);
    }
    bundle.lens.intrinsics = arrays.intrinsics;
    bundle.warp_mm = Eigen::Vector2d(arrays.warp.x2, arrays.warp.y2) / kM_per_mm;
    outcome.finite = bundle.warp_mm.allFinite();
    for (const double value : arrays.intrinsics) outcome.finite = outcome.finite && std::isfinite(value);
    for (const double value : residuals) outcome.finite = outcome.finite && std::isfinite(value);
    for (std::size_t v = 0; v < bundle.pictures.size(); ++v) {
      BundlePicture& picture = bundle.pictures[v];
      picture.camera_from_lattice = isometry_of_pose(arrays.frames[v]);
      outcome.finite = outcome.finite && picture.camera_from_lattice.matrix().allFinite();
      for (std::size_t c = 0; c < picture.corners.size(); ++c)
        picture.used[c] = arrays.pool[v * arrays.nodes() + arrays.node(picture.corners[c])].z > 0.0;
    }
  });
  return outcome;
}

BundleUncertainty linearise(const LensBundle& bundle, const BundleFreedom& freedom) {
  require_sound(bundle);
  BundleUncertainty result;
  run_with_large_stack([&] {
    Arrays arrays(bundle, freedom);
    const LinearFit fit = linear_fit(arrays);
    add_errors(bundle, arrays, fit.residuals, result);
    add_covariance(number_of_intrinsics(bundle.lens.model), arrays, fit, result);
  });
  return result;
}

Eigen::Matrix2d projection_covariance(const LensBundle& bundle, const BundleUncertainty& uncertainty,
                                      const Eigen::Vector2d& pixel, double distance_mm) {
  const mrcal_lensmodel_t model = mrcal_model(bundle.lens.model);
  const int lens = number_of_intrinsics(bundle.lens.model);
  const Eigen::Vector3d in_camera = distance_mm * ray_of(bundle.lens, pixel);
  const mrcal_point3_t point{{in_camera.x(), in_camera.y(), in_camera.z()}};
  mrcal_point2_t seen;
  std::array<mrcal_point3_t, 2> by_point;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> by_lens(2, lens);
  if (!mrcal_project(&seen, by_point.data(), by_lens.data(), &point, 1, &model, bundle.lens.intrinsics.data()))
    throw std::runtime_error("lens: a point could not be projected; calibrate again");
  Eigen::Matrix<double, 2, 3> pixel_by_point;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      pixel_by_point(row, column) = by_point[static_cast<std::size_t>(row)].xyz[column];
  Eigen::MatrixXd by_state = Eigen::MatrixXd::Zero(2, uncertainty.covariance.rows());
  by_state.leftCols(lens) = by_lens;
  const double share = 1.0 / static_cast<double>(bundle.pictures.size());
  for (std::size_t v = 0; v < bundle.pictures.size(); ++v) {
    const Eigen::Isometry3d& pose = bundle.pictures[v].camera_from_lattice;
    const Eigen::Vector3d on_board = pose.inverse() * in_camera;
    Eigen::Matrix<double, 6, 1> motion;
    motion << rotation_vector(pose.linear()), pose.translation();
    Eigen::Vector3d moved;
    Eigen::Matrix<double, 3, 6, Eigen::RowMajor> by_pose;
    mrcal_transform_point_rt(moved.data(), by_pose.data(), nullptr, motion.data(), on_board.data());
    by_state.middleCols<6>(lens + 6 * static_cast<Eigen::Index>(v)) = share * pixel_by_point * by_pose;
  }
  return by_state * uncertainty.covariance * by_state.transpose();
}

void write_cameramodel(const ModelledLens& lens, const std::filesystem::path& file) {
  const std::size_t size = sizeof(mrcal_cameramodel_t) + lens.intrinsics.size() * sizeof(double);
  const std::unique_ptr<mrcal_cameramodel_t, decltype(&std::free)> model(
      static_cast<mrcal_cameramodel_t*>(std::calloc(1, size)), &std::free);
  if (!model) throw std::runtime_error("cannot write " + file.string() + ": out of memory");
  model->imagersize[0] = static_cast<unsigned>(lens.image_size.width);
  model->imagersize[1] = static_cast<unsigned>(lens.image_size.height);
  model->lensmodel = mrcal_model(lens.model);
  std::copy(lens.intrinsics.begin(), lens.intrinsics.end(), model->intrinsics);
  std::string messages;
  bool written = false;
  {
    const CaughtStandardError caught(messages);
    written = mrcal_write_cameramodel_file(file.c_str(), model.get());
  }
  if (!written) throw std::runtime_error("cannot write " + file.string() + ": choose a writable folder");
}

}  // namespace calibration
