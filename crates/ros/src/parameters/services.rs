//! The services that `ros2 param` and others call.

use super::{Parameter, ParameterValue, Parameters, unknown};
use crate::node::Service;
use ros2_client::{
    parameters::raw,
    rcl_interfaces::{
        DescribeParametersRequest, DescribeParametersResponse, GetParameterTypesRequest,
        GetParameterTypesResponse, GetParametersRequest, GetParametersResponse,
        ListParametersRequest, ListParametersResponse, SetParametersAtomicallyResponse,
        SetParametersRequest, SetParametersResponse,
    },
};
use std::sync::Arc;

/// All six of them, below the node of the absolute name `node`.
#[must_use]
pub fn services(parameters: &Arc<Parameters>, node: &str) -> Vec<Service> {
    let mut services = asking(parameters, node);
    services.extend(setting(parameters, node));
    services
}

/// What is answered from the parameters as they are.
fn asking(parameters: &Arc<Parameters>, node: &str) -> Vec<Service> {
    let [get, types, list, describe] = [0; 4].map(|_| Arc::clone(parameters));
    vec![
        service(
            node,
            "get_parameters",
            "GetParameters",
            move |asked: GetParametersRequest| {
                let values = asked.names.iter().map(|name| get.get(name).into());
                GetParametersResponse {
                    values: values.collect(),
                }
            },
        ),
        service(
            node,
            "get_parameter_types",
            "GetParameterTypes",
            move |asked: GetParameterTypesRequest| {
                let type_of =
                    |name: &String| ParameterValue::to_parameter_type_raw(&types.get(name));
                GetParameterTypesResponse {
                    values: asked.names.iter().map(type_of).collect(),
                }
            },
        ),
        service(
            node,
            "list_parameters",
            "ListParameters",
            move |asked: ListParametersRequest| ListParametersResponse {
                result: list.list(&asked.prefixes, asked.depth),
            },
        ),
        service(
            node,
            "describe_parameters",
            "DescribeParameters",
            move |asked: DescribeParametersRequest| {
                let described = |name: &String| {
                    let found = describe.find(name);
                    found.map_or_else(|| unknown(name), Parameter::descriptor)
                };
                DescribeParametersResponse {
                    values: asked.names.iter().map(described).collect(),
                }
            },
        ),
    ]
}

/// What changes them.
fn setting(parameters: &Arc<Parameters>, node: &str) -> Vec<Service> {
    let [each, together] = [0; 2].map(|_| Arc::clone(parameters));
    vec![
        service(
            node,
            "set_parameters",
            "SetParameters",
            move |asked: SetParametersRequest| {
                let values = named(asked.parameter).into_iter();
                SetParametersResponse {
                    results: values.map(|one| each.set(vec![one]).into()).collect(),
                }
            },
        ),
        service(
            node,
            "set_parameters_atomically",
            "SetParametersAtomically",
            move |asked: SetParametersRequest| SetParametersAtomicallyResponse {
                result: together.set(named(asked.parameter)).into(),
            },
        ),
    ]
}

fn service<Q: serde::de::DeserializeOwned, A: serde::Serialize>(
    node: &str,
    name: &str,
    type_name: &'static str,
    answer: impl FnMut(Q) -> A + Send + 'static,
) -> Service {
    Service::new(
        format!("{node}/{name}"),
        ("rcl_interfaces", type_name),
        answer,
    )
}

fn named(parameters: Vec<raw::Parameter>) -> Vec<(String, ParameterValue)> {
    let named = |parameter: raw::Parameter| (parameter.name, parameter.value.into());
    parameters.into_iter().map(named).collect()
}
