//! Joints and how they hang together.

use crate::{Affine, Error, Pose, Transform};

/// A joint of a [`Skeleton`].
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name; need not be there nor be unique.
    pub name: Option<String>,
    /// The number of the joint that it hangs from; `None` for a root. Parents may stand anywhere in the list.
    pub parent: Option<usize>,
    /// The transform from its space to its parent's in the rest pose.
    pub rest: Transform,
}

/// Joints that form one or more trees.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    joints: Vec<Joint>,
    /// All joints, parents before children.
    order: Vec<usize>,
}

impl Skeleton {
    /// Checks that the joints form trees.
    ///
    /// # Errors
    /// If a parent is not there, or a joint is its own ancestor.
    pub fn new(joints: Vec<Joint>) -> Result<Self, Error> {
        let order = parents_first(&joints)?;
        Ok(Self { joints, order })
    }

    /// All joints, in the order that they were given in.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The number of the first joint of that name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name.as_deref() == Some(name))
    }

    /// Every joint as it rests.
    #[must_use]
    pub fn rest_pose(&self) -> Pose {
        Pose { locals: self.joints.iter().map(|joint| joint.rest).collect() }
    }

    /// For each joint the map from its space to the world: `world(parent) · local`.
    ///
    /// # Panics
    /// If the pose has another number of joints.
    #[must_use]
    pub fn world_from_joints(&self, pose: &Pose) -> Vec<Affine> {
        assert_eq!(pose.locals.len(), self.joints.len(), "a pose needs one transform for each joint");
        let mut world = vec![Affine::IDENTITY; self.joints.len()];
        for &joint in &self.order {
            let local = pose.locals[joint].to_affine();
            world[joint] = self.joints[joint].parent.map_or(local, |parent| world[parent].after(&local));
        }
        world
    }
}

/// All joints, parents before children and roots in their own order.
fn parents_first(joints: &[Joint]) -> Result<Vec<usize>, Error> {
    let mut children = vec![Vec::new(); joints.len()];
    let mut order = Vec::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        match joint.parent {
            None => order.push(index),
            Some(parent) if parent < joints.len() => children[parent].push(index),
            Some(parent) => {
                let count = joints.len();
                return Err(Error::Skeleton(format!("joint {index} hangs from joint {parent}, but there are {count}")));
            }
        }
    }
    let mut next = 0;
    while let Some(&joint) = order.get(next) {
        order.extend(&children[joint]);
        next += 1;
    }
    if order.len() == joints.len() {
        return Ok(order);
    }
    // What no root leads to hangs, at some distance, from a cycle.
    let mut is_reached = vec![false; joints.len()];
    order.iter().for_each(|&joint| is_reached[joint] = true);
    let lost = is_reached.iter().position(|&is_reached| !is_reached).unwrap_or_default();
    Err(Error::Skeleton(format!("joint {lost} hangs from a cycle of joints")))
}
