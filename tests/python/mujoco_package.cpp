/// What hmax.check takes of the Python package mujoco, over the library of Debian, which has no such package.
#include <mujoco/mujoco.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <stdexcept>
#include <string>

namespace py = pybind11;

namespace {

struct Model {
  explicit Model(const std::string& file) : m(mj_loadXML(file.c_str(), nullptr, error, sizeof error)) {
    if (!m) throw std::runtime_error(error);
  }
  ~Model() { mj_deleteModel(m); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  char error[500] = "";
  mjModel* m;
};

struct Data {
  explicit Data(const Model& model) : m(model.m), d(mj_makeData(model.m)) {}
  ~Data() { mj_deleteData(d); }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  const mjModel* m;
  mjData* d;
};

/// numpy sees the numbers of MuJoCo themselves.
template <class Number>
py::array_t<Number> view(py::handle owner, Number* numbers, int count) {
  return {{count}, {sizeof(Number)}, numbers, owner};
}

template <class Number>
void add_array(py::class_<Data>& data, const char* name, Number* mjData::*numbers, int mjModel::*count) {
  data.def_property_readonly(name, [=](py::object self) {
    const Data& of = self.cast<const Data&>();
    return view(self, of.d->*numbers, of.m->*count);
  });
}

template <class Number>
void add_array(py::class_<Model>& model, const char* name, Number* mjModel::*numbers, int mjModel::*count) {
  model.def_property_readonly(name, [=](py::object self) {
    const mjModel* m = self.cast<const Model&>().m;
    return view(self, m->*numbers, m->*count);
  });
}

}  // namespace

PYBIND11_MODULE(mujoco, module) {
  // Never freed: at the end of the process Python is gone before.
  static auto* const warning = new py::object(py::none());
  module.def("get_mju_user_warning", [] { return *warning; });
  module.def("set_mju_user_warning", [](py::object function) {
    *warning = std::move(function);
    mju_user_warning = [](const char* text) {
      if (!warning->is_none()) (*warning)(text);
    };
  });
  py::class_<mjOption>(module, "MjOption").def_readwrite("timestep", &mjOption::timestep);
  py::class_<mjStatistic>(module, "MjStatistic").def_readonly("meansize", &mjStatistic::meansize);
  py::class_<mjWarningStat>(module, "MjWarningStat").def_readonly("number", &mjWarningStat::number);
  auto model = py::class_<Model>(module, "MjModel");
  model.def_static("from_xml_path", [](const std::string& file) { return std::make_unique<Model>(file); })
      .def_property_readonly(
          "opt", [](Model& of) { return &of.m->opt; }, py::return_value_policy::reference_internal)
      .def_property_readonly(
          "stat", [](Model& of) { return &of.m->stat; }, py::return_value_policy::reference_internal)
      .def_property_readonly("nq", [](const Model& of) { return of.m->nq; })
      .def_property_readonly("nv", [](const Model& of) { return of.m->nv; })
      .def_property_readonly("na", [](const Model& of) { return of.m->na; });
  add_array(model, "jnt_type", &mjModel::jnt_type, &mjModel::njnt);
  add_array(model, "jnt_qposadr", &mjModel::jnt_qposadr, &mjModel::njnt);
  add_array(model, "jnt_dofadr", &mjModel::jnt_dofadr, &mjModel::njnt);
  add_array(model, "dof_damping", &mjModel::dof_damping, &mjModel::nv);
  add_array(model, "dof_M0", &mjModel::dof_M0, &mjModel::nv);
  auto data =
      py::class_<Data>(module, "MjData")
          .def(py::init<const Model&>(), py::keep_alive<1, 2>())
          .def_property(
              "time", [](const Data& of) { return of.d->time; }, [](Data& of, double t) { of.d->time = t; })
          .def_property_readonly("warning", [](const Data& of) {
            py::list all;
            for (const mjWarningStat& each : of.d->warning) all.append(each);
            return all;
          });
  add_array(data, "qpos", &mjData::qpos, &mjModel::nq);
  add_array(data, "qvel", &mjData::qvel, &mjModel::nv);
  add_array(data, "act", &mjData::act, &mjModel::na);
  add_array(data, "ctrl", &mjData::ctrl, &mjModel::nu);
  add_array(data, "qacc_warmstart", &mjData::qacc_warmstart, &mjModel::nv);
  py::enum_<mjtJoint>(module, "mjtJoint")
      .value("mjJNT_FREE", mjJNT_FREE)
      .value("mjJNT_BALL", mjJNT_BALL)
      .value("mjJNT_SLIDE", mjJNT_SLIDE);
  py::enum_<mjtWarning>(module, "mjtWarning")
      .value("mjWARN_BADQPOS", mjWARN_BADQPOS)
      .value("mjWARN_BADQVEL", mjWARN_BADQVEL)
      .value("mjWARN_BADQACC", mjWARN_BADQACC);
  module.def("mj_versionString", &mj_versionString);
  module.def("mj_step", [](const Model& m, Data& d) { mj_step(m.m, d.d); });
  module.def("mj_copyData",
             [](Data& to, const Model& m, const Data& from) { mj_copyData(to.d, m.m, from.d); });
}
