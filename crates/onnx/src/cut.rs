//! The first part of a network: a graph that ends with inner tensors, its feature maps.

use crate::wire::{Field, Malformed, fields, put, put_number};
use std::collections::HashSet;

/// Field numbers of ONNX's messages (`onnx.proto`).
mod number {
    pub(super) const MODEL_GRAPH: u64 = 7;
    pub(super) const GRAPH_NODE: u64 = 1;
    pub(super) const GRAPH_INITIALIZER: u64 = 5;
    pub(super) const GRAPH_INPUT: u64 = 11;
    pub(super) const GRAPH_OUTPUT: u64 = 12;
    pub(super) const GRAPH_VALUE_INFO: u64 = 13;
    pub(super) const NODE_INPUT: u64 = 1;
    pub(super) const NODE_OUTPUT: u64 = 2;
    pub(super) const TENSOR_NAME: u64 = 8;
    pub(super) const VALUE_NAME: u64 = 1;
    pub(super) const VALUE_TYPE: u64 = 2;
    pub(super) const TYPE_TENSOR: u64 = 1;
    pub(super) const TENSOR_ELEMENT: u64 = 1;
    pub(super) const TENSOR_SHAPE: u64 = 2;
    pub(super) const SHAPE_DIMENSION: u64 = 1;
    pub(super) const DIMENSION_VALUE: u64 = 1;
    pub(super) const DIMENSION_NAME: u64 = 2;
}

/// ONNX's number for 32-bit floats.
const FLOAT: u64 = 1;
const CHANNELS: u64 = 3;

/// A graph that cannot be cut so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CutError {
    /// Not an ONNX file.
    #[error("it is not an ONNX model")]
    NotAModel,
    /// The graph makes no such tensors: another network.
    #[error("its graph has no tensor `{0}`")]
    NoTensor(String),
    /// Not a network with one image input.
    #[error("it has {0} inputs, a detector has one image")]
    Inputs(usize),
}

impl From<Malformed> for CutError {
    fn from(_: Malformed) -> Self {
        Self::NotAModel
    }
}

/// The part of `model`, an ONNX file's bytes, that makes `tensors`: it takes `[N, 3, height, width]` 32-bit
/// floats of any size and gives those tensors, in that order.
///
/// # Errors
/// See [`CutError`].
pub fn cut(model: &[u8], tensors: &[String]) -> Result<Vec<u8>, CutError> {
    let mut made = Vec::new();
    let mut graphs = 0;
    for field in fields(model) {
        let field = field?;
        if field.number == number::MODEL_GRAPH {
            graphs += 1;
            put(&mut made, field.number, &cut_graph(field.content, tensors)?);
        } else {
            made.extend_from_slice(field.whole);
        }
    }
    if graphs == 1 {
        Ok(made)
    } else {
        Err(CutError::NotAModel)
    }
}

fn cut_graph(graph: &[u8], tensors: &[String]) -> Result<Vec<u8>, CutError> {
    let all: Vec<Field<'_>> = fields(graph).collect::<Result<_, _>>()?;
    let nodes: Vec<Field<'_>> = of(&all, number::GRAPH_NODE).collect();
    let (mut kept, needed) = nodes_before(&nodes, tensors)?;
    let mut constants = HashSet::new();
    for constant in of(&all, number::GRAPH_INITIALIZER) {
        let name = texts(constant.content, number::TENSOR_NAME)?;
        if name.iter().any(|name| needed.contains(name)) {
            kept.extend_from_slice(constant.whole);
        }
        constants.extend(name);
    }
    let image = image_name(&all, &constants)?;
    put(&mut kept, number::GRAPH_INPUT, &image_input(image));
    for tensor in tensors {
        let mut value = Vec::new();
        put(&mut value, number::VALUE_NAME, tensor.as_bytes());
        put(&mut kept, number::GRAPH_OUTPUT, &value);
    }
    for field in all
        .iter()
        .filter(|field| !REWRITTEN.contains(&field.number))
    {
        kept.extend_from_slice(field.whole);
    }
    Ok(kept)
}

/// Fields of a graph that a cut writes anew, or leaves out: shapes of inner values are those of the old input.
const REWRITTEN: [u64; 5] = [
    number::GRAPH_NODE,
    number::GRAPH_INITIALIZER,
    number::GRAPH_INPUT,
    number::GRAPH_OUTPUT,
    number::GRAPH_VALUE_INFO,
];

fn of<'a>(all: &[Field<'a>], number: u64) -> impl Iterator<Item = Field<'a>> {
    all.iter()
        .copied()
        .filter(move |field| field.number == number)
}

/// The nodes that `tensors` need, as they stand, and the names of everything that these take.
fn nodes_before<'a>(
    nodes: &[Field<'a>],
    tensors: &'a [String],
) -> Result<(Vec<u8>, HashSet<&'a [u8]>), CutError> {
    let mut needed: HashSet<&[u8]> = tensors.iter().map(String::as_bytes).collect();
    let mut kept = Vec::new();
    let mut outputs = HashSet::new();
    // Every node comes after those that make its inputs.
    for node in nodes.iter().rev() {
        let made = texts(node.content, number::NODE_OUTPUT)?;
        if made.iter().any(|output| needed.contains(output)) {
            needed.extend(texts(node.content, number::NODE_INPUT)?);
            kept.push(node.whole);
        }
        outputs.extend(made);
    }
    let absent = tensors
        .iter()
        .find(|name| !outputs.contains(name.as_bytes()));
    match absent {
        Some(name) => Err(CutError::NoTensor(name.clone())),
        None => Ok((kept.into_iter().rev().flatten().copied().collect(), needed)),
    }
}

/// The name of the one input that is no constant: old exporters list constants among the inputs.
fn image_name<'a>(all: &[Field<'a>], constants: &HashSet<&[u8]>) -> Result<&'a [u8], CutError> {
    let inputs = of(all, number::GRAPH_INPUT).map(|input| name_of(input.content));
    let inputs: Vec<&[u8]> = inputs.collect::<Result<_, _>>()?;
    let images = inputs.into_iter().filter(|name| !constants.contains(name));
    let images: Vec<&[u8]> = images.collect();
    match images[..] {
        [image] => Ok(image),
        _ => Err(CutError::Inputs(images.len())),
    }
}

/// Values of a repeated text field.
fn texts(message: &[u8], number: u64) -> Result<Vec<&[u8]>, CutError> {
    let mut found = Vec::new();
    for field in fields(message) {
        let field = field?;
        if field.number == number {
            found.push(field.content);
        }
    }
    Ok(found)
}

fn name_of(value: &[u8]) -> Result<&[u8], CutError> {
    let names = texts(value, number::VALUE_NAME)?;
    names.first().copied().ok_or(CutError::NotAModel)
}

/// `name: float[batch, 3, height, width]`.
fn image_input(name: &[u8]) -> Vec<u8> {
    let mut shape = Vec::new();
    for side in ["batch", "", "height", "width"] {
        let mut dimension = Vec::new();
        if side.is_empty() {
            put_number(&mut dimension, number::DIMENSION_VALUE, CHANNELS);
        } else {
            put(&mut dimension, number::DIMENSION_NAME, side.as_bytes());
        }
        put(&mut shape, number::SHAPE_DIMENSION, &dimension);
    }
    let (mut tensor, mut kind, mut value) = (Vec::new(), Vec::new(), Vec::new());
    put_number(&mut tensor, number::TENSOR_ELEMENT, FLOAT);
    put(&mut tensor, number::TENSOR_SHAPE, &shape);
    put(&mut kind, number::TYPE_TENSOR, &tensor);
    put(&mut value, number::VALUE_NAME, name);
    put(&mut value, number::VALUE_TYPE, &kind);
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A graph of `x -> a -> b -> c`, with a constant for each node.
    fn chain() -> Vec<u8> {
        let mut graph = Vec::new();
        for (input, output) in [("x", "a"), ("a", "b"), ("b", "c")] {
            let mut node = Vec::new();
            put(&mut node, number::NODE_INPUT, input.as_bytes());
            put(
                &mut node,
                number::NODE_INPUT,
                format!("w_{output}").as_bytes(),
            );
            put(&mut node, number::NODE_OUTPUT, output.as_bytes());
            put(&mut graph, number::GRAPH_NODE, &node);
            let mut constant = Vec::new();
            put(
                &mut constant,
                number::TENSOR_NAME,
                format!("w_{output}").as_bytes(),
            );
            put(&mut graph, number::GRAPH_INITIALIZER, &constant);
        }
        let mut input = Vec::new();
        put(&mut input, number::VALUE_NAME, b"x");
        put(&mut graph, number::GRAPH_INPUT, &input);
        let mut model = Vec::new();
        put_number(&mut model, 1, 8);
        put(&mut model, number::MODEL_GRAPH, &graph);
        model
    }

    fn count(model: &[u8], wanted: u64) -> usize {
        let graph = fields(model).map(|field| field.expect("a field"));
        let graph = graph.last().expect("a graph").content;
        fields(graph)
            .filter(|field| field.expect("a field").number == wanted)
            .count()
    }

    #[test]
    fn what_comes_after_the_tensors_is_left_out() {
        let first = cut(&chain(), &["b".to_owned()]).expect("a graph");
        assert_eq!(count(&first, number::GRAPH_NODE), 2);
        assert_eq!(count(&first, number::GRAPH_INITIALIZER), 2);
        assert_eq!(count(&first, number::GRAPH_OUTPUT), 1);
    }

    #[test]
    fn a_tensor_of_another_network_is_named() {
        let refused = cut(&chain(), &["d".to_owned()]);
        assert_eq!(refused, Err(CutError::NoTensor("d".to_owned())));
    }

    #[test]
    fn text_and_cut_off_files_are_no_models() {
        assert_eq!(cut(b"not a model", &[]), Err(CutError::NotAModel));
        let whole = chain();
        assert_eq!(
            cut(&whole[..whole.len() - 3], &[]),
            Err(CutError::NotAModel)
        );
    }
}
