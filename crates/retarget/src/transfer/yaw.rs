//! An angle about the vertical axis over time.

/// An angle about +Y over time, linear between its keys. Angles are not wrapped.
#[derive(Debug, Clone)]
pub struct Yaw {
    pub times: Vec<f32>,
    pub radians: Vec<f64>,
}

impl Yaw {
    pub fn at(&self, time_secs: f32) -> f64 {
        let from = self.times.partition_point(|&start| start <= time_secs).saturating_sub(1);
        match self.times.get(from + 1) {
            Some(&end) if time_secs > self.times[from] => {
                let factor = f64::from(time_secs - self.times[from]) / f64::from(end - self.times[from]);
                self.radians[from] + factor * (self.radians[from + 1] - self.radians[from])
            }
            _ => self.radians.get(from).copied().unwrap_or(0.0),
        }
    }
}
